"""Gait events from the motion of the feet and, where a plate is hit, from its force.

A foot stands when its slowest point, heel or toe, is slow beside the walking speed: this holds for any walking
direction, for turns, and whether heel, toe or flat foot lands first. The two fractions of the walking speed were chosen
on the walks of ../shared/data together (no file has its own); the median error of either kind is then within 3 ms, and
changing them by 20 % changes the accuracy by less than 10 ms.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gaitlab.mocap.cycles import cycles
from gaitlab.mocap.feet import FootMotion, foot_motion, walking_speed
from gaitlab.mocap.plate_contacts import plate_edges
from gaitlab.mocap.recording import Event, EventKind, Recording, Side

SIDES: tuple[Side, Side] = ("left", "right")


@dataclass(frozen=True, kw_only=True)
class EventSettings:
    """What counts as contact. Speeds are fractions of the walking speed, so that they fit children and slow walkers."""

    cut_off: float = 20.0
    """Low-pass cut-off of the foot markers [Hz]."""
    strike_speed: float = 0.35
    """Foot strike: the slower of heel and toe falls below this."""
    off_speed: float = 1.0
    """Foot off: the slower of heel and toe rises above this."""
    shortest_phase: float = 0.1
    """A shorter stance or swing is a scuff or a slip and is no phase [s]."""
    plate_window: float = 0.08
    """A plate's edge replaces an event at most this far away [s]; see the accuracy of the kinematic events."""


DEFAULTS = EventSettings()


def detect_events(recording: Recording, settings: EventSettings = DEFAULTS) -> tuple[Event, ...]:
    """Foot strikes and foot offs of a walk in time order, whatever events the file holds.

    Raises:
        InvalidRecording: Pelvis or foot markers are never visible, or nobody walks.
    """
    speed = walking_speed(recording)
    motions = [foot_motion(recording, side, settings.cut_off) for side in SIDES]
    events = [event for motion in motions for event in kinematic_events(motion, recording.rate, speed, settings)]
    for edge in plate_edges(recording, motions):
        near = [
            k
            for k, event in enumerate(events)
            if event.kind == edge.kind
            and event.side in edge.sides
            and abs(event.time - edge.time) <= settings.plate_window
        ]
        if near:
            closest = min(near, key=lambda k: abs(events[k].time - edge.time))
            events[closest] = replace(events[closest], time=edge.time)
    return tuple(sorted(events, key=lambda event: event.time))


def events_of(recording: Recording, redetect: bool = False) -> tuple[Event, ...]:
    """The file's events when both feet make a full stride in them, otherwise detected ones.

    When detection finds no more full strides than the file has, the file's events are kept.

    Args:
        recording: The trial.
        redetect: Ignore the file's events.
    """
    stored = [len(cycles(recording.events, side)) for side in SIDES]
    if min(stored) > 0 and not redetect:
        return recording.events
    detected = detect_events(recording)
    found = sum(len(cycles(detected, side)) for side in SIDES)
    return detected if redetect or found > sum(stored) else recording.events


def kinematic_events(motion: FootMotion, rate: float, speed: float, settings: EventSettings) -> list[Event]:
    """Events of one foot from its speeds.

    A foot strike needs the heel in view and a foot off the toe: when only the other end is seen, the foot may have
    landed or risen before, and no event is made up. With the toe hidden, a fast heel that stops is a strike.

    Args:
        motion: The foot.
        rate: Frames per second [Hz].
        speed: Walking speed [m/s].
        settings: Thresholds.
    """
    slowest = np.fmin(motion.heel_speed, motion.toe_speed) / speed
    heel, toe = np.isfinite(motion.heel_speed), np.isfinite(motion.toe_speed)
    ground = slowest < settings.strike_speed
    air = slowest > settings.off_speed
    seen_on = np.concatenate([[False], (heel[1:] & heel[:-1]) & (toe[1:] == toe[:-1])])  # no jump from marker to marker
    seen_off = np.concatenate([[False], toe[1:] & toe[:-1]])
    events: list[Event] = []
    standing: bool | None = None
    for i in range(len(slowest)):
        if not (heel[i] or toe[i]):
            standing = None
        elif ground[i]:
            if standing is False and seen_on[i]:
                events.append(_event(motion.side, "foot_strike", i, slowest, settings.strike_speed, rate))
            standing = True
        elif air[i]:
            if standing is True and seen_off[i]:
                events.append(_event(motion.side, "foot_off", i, slowest, settings.off_speed, rate))
            standing = False
    return _without_short_phases(events, settings.shortest_phase)


def _event(side: Side, kind: EventKind, i: int, slowest: np.ndarray, level: float, rate: float) -> Event:
    """The event where `slowest` crosses `level` between frames i - 1 and i."""
    step = slowest[i] - slowest[i - 1]
    share = (level - slowest[i - 1]) / step if step != 0 else 1.0
    return Event(side=side, kind=kind, time=(i - 1 + float(share)) / rate, source="detected")


def _without_short_phases(events: Sequence[Event], shortest: float) -> list[Event]:
    """Removes both ends of the shortest phase until no phase between two neighbouring events is too short."""
    kept = list(events)
    while len(kept) > 1:
        lengths = [after.time - before.time for before, after in zip(kept, kept[1:], strict=False)]
        k = int(np.argmin(lengths))
        if lengths[k] >= shortest:
            break
        del kept[k : k + 2]
    return kept
