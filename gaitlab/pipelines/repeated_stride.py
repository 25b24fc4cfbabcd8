"""A stride of the model walked three times, as a laboratory would have recorded it: markers, events, ground reactions.

The middle stride is the model's own. The stride before and after it are the same, their postures bent linearly where
the measured stride does not end exactly as it began, so that the walk has no jumps. The laboratory has a plate per
foot that lies under the whole walk, so that every stance is measured.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..mocap.plate_assignment import PlateContact
from ..mocap.recording import Event, ForcePlate, Recording, Side
from ..multibody.kinematics import point_positions
from ..walking.model import POINTS
from .gait_frame import gait_to_lab
from .optimal_arrays import ModelledStride

RATE, PLATE_RATE = 100.0, 1000.0  # [Hz]
SIDES: tuple[Side, Side] = ("right", "left")
HALF = 10.0  # [m], half the length of a plate


@dataclass(frozen=True)
class RepeatedStride:
    """Three strides; time 0 at the first frame, in which the first of them begins."""

    stride: ModelledStride
    """Its first node has the time 0."""
    heading: float
    """Direction of the gait frame in the laboratory [rad]."""

    @property
    def duration(self) -> float:
        """Stride time [s]."""
        return float(self.stride.times[-1])

    @property
    def n_frames(self) -> int:
        """Frames at `RATE`."""
        return int(3.0 * self.duration * RATE) + 1

    def coordinates(self, time: np.ndarray) -> np.ndarray:
        """Coordinates at times [s] of shape (n,), gait frame [m, rad], shape (n, n_q)."""
        states = self.stride.problem.states(self.stride.w)
        apart = (states[-1] - states[0])[: self.stride.subject.n_q]
        number = np.clip(np.floor(time / self.duration), 0, 2)
        within = time - number * self.duration
        phase = (within / self.duration)[:, None]
        # Forward the walk goes on; everything else comes back to where it was.
        bend = np.where(np.arange(len(apart)) == 0, 0.0, apart)
        on = np.where(np.arange(len(apart)) == 0, apart, 0.0)
        q = self.stride.coordinates(states, np.clip(within, 0.0, self.duration))
        q += (number[:, None] - 1.0) * on
        q -= np.where(number[:, None] == 0.0, phase * bend, 0.0)
        return q + np.where(number[:, None] == 2.0, (1.0 - phase) * bend, 0.0)

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Foot strikes and foot offs of all three strides, in time order."""
        layout = self.stride.problem.shared.layout
        found: list[Event] = []
        for side, heights in zip(SIDES, ({2, 5}, {8, 11}), strict=True):
            stands = [bool(heights & set(stage.active)) for stage in layout.stages]
            starts = np.concatenate([[0], np.cumsum([stage.n_intervals for stage in layout.stages])[:-1]])
            for k, start in enumerate(starts):
                if stands[k] == stands[k - 1]:
                    continue
                kind = "foot_strike" if stands[k] else "foot_off"
                times = self.stride.times[start] + self.duration * np.arange(4)
                found += [
                    Event(side=side, kind=kind, time=float(t), source="detected")
                    for t in times
                    if t <= (self.n_frames - 1) / RATE
                ]
        return tuple(sorted(found, key=lambda event: event.time))

    def recording(self, name: str, parameters: Mapping[str, float]) -> Recording:
        """The trial, laboratory frame, with the body parameters of the person."""
        time = np.arange(self.n_frames) / RATE
        subject = self.stride.subject
        markers = point_positions(subject, subject.markers, self.coordinates(time))
        return Recording(
            name=name,
            sha256="",
            rate=RATE,
            first_frame=0,
            markers={key: gait_to_lab(value, self.heading) for key, value in markers.items()},
            force_plates=tuple(self._plate(side) for side in SIDES),
            events=self.events,
            parameters=parameters,
        )

    @cached_property
    def contacts(self) -> tuple[PlateContact, ...]:
        """Every stance with the plate of its foot."""
        end = (self.n_frames - 1) / RATE
        found: list[PlateContact] = []
        for plate, side in enumerate(SIDES):
            own = [event for event in self.events if event.side == side]
            strikes = [event.time for event in own if event.kind == "foot_strike"]
            offs = [event.time for event in own if event.kind == "foot_off"]
            if offs and (not strikes or offs[0] < strikes[0]):
                strikes = [0.0, *strikes]
            for start in strikes:
                off = min((time for time in offs if time > start), default=end)
                found.append(PlateContact(plate=plate, start=start, end=off, side=side, reason=""))
        return tuple(sorted(found, key=lambda contact: contact.start))

    def _plate(self, side: Side) -> ForcePlate:
        """A plate at the height of the floor that only this foot loads."""
        n = self.n_frames * round(PLATE_RATE / RATE)
        time = np.arange(n) / PLATE_RATE
        q = self.coordinates(np.minimum(time, (self.n_frames - 1) / RATE))
        places = point_positions(self.stride.subject, self.stride.subject.contacts, q)
        loads = self.stride.between_points(self.stride.forces(), time % self.duration).reshape(n, len(POINTS), 3)
        middle = np.array([float(np.mean(q[:, 0])), float(np.mean(q[:, 1])), self.stride.floor])
        force, moment = np.zeros((n, 3)), np.zeros((n, 3))
        for i, point in enumerate(POINTS):
            if point.startswith(side):
                force += loads[:, i]
                moment += np.cross((places[point] - middle) * (1.0, 1.0, 0.0), loads[:, i])
        corners = middle + HALF * np.array([[1.0, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
        turned = [gait_to_lab(values, self.heading) for values in (corners, force, moment)]
        return ForcePlate(corners=turned[0], force=turned[1], moment=turned[2], rate=PLATE_RATE)
