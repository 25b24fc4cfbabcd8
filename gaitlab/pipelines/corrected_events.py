"""Events that somebody corrected, in the place of the file's or the detected ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import InvalidRecording
from ..mocap.events import events_of
from ..mocap.recording import Event, EventKind, Recording, Side


@dataclass(frozen=True, kw_only=True)
class CorrectedEvent:
    """One event, as an editor gives it."""

    side: Side
    kind: EventKind
    time_s: float
    """From the first stored frame [s]."""


Corrections = Mapping[str, Sequence[CorrectedEvent]]
"""All events of a trial, by its name."""


def check_trials(corrections: Corrections, walks: Sequence[Recording]) -> None:
    """Refuse events of a trial that is not analysed: they would be missed.

    Raises:
        InvalidRecording: There is no such trial.
    """
    names = [walk.name for walk in walks]
    for name in corrections:
        if name not in names:
            raise InvalidRecording(f"events are given for {name}, which is no walk here; there are {', '.join(names)}")


def events_to_use(recording: Recording, corrections: Corrections, redetect: bool) -> tuple[Event, ...]:
    """The corrected events in time order; without any, the file's or detected ones.

    Raises:
        InvalidRecording: An event lies outside of the recording.
    """
    given = corrections.get(recording.name)
    if given is None:
        return events_of(recording, redetect=redetect)
    end = (recording.n_frames - 1) / recording.rate
    for event in given:
        if not 0.0 <= event.time_s <= end:
            raise InvalidRecording(
                f"{recording.name}: the {event.side} {event.kind.replace('_', ' ')} at {event.time_s:g} s lies outside "
                f"of the recording, which goes from 0 to {end:.2f} s"
            )
    events = [Event(side=each.side, kind=each.kind, time=each.time_s, source="corrected") for each in given]
    return tuple(sorted(events, key=lambda event: event.time))
