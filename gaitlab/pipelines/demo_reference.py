"""The reference gait as a walk: its coordinates, its events, and ground forces that roughly carry it."""

import casadi as ca
import numpy as np

from ..mocap.recording import Event, EventKind, Side, SoleChange, SoleChangeKind
from ..multibody.dynamics import inverse_dynamics, layout_of, parameter_vector
from .demo_gait import ReferenceGait, in_contact
from .demo_patterns import SIDES, GaitPattern
from .demo_recording import PLATE_RATE, RATE, SimulatedWalk

STRIDES = 3
"""Strides in a recording: whole ones, so that the line between its ends is the direction of the walk. The right stride
in the middle is the optimal one."""
ROLLING = 0.04  # [s], in which load moves from one contact point to the next


def recording_time(pattern: GaitPattern, rate: float) -> np.ndarray:
    """Times of samples at a rate [Hz], 0 at the right foot strike in the recording, shape (n,) [s]."""
    return -pattern.stride_time + np.arange(round(STRIDES * pattern.stride_time * rate) + 1) / rate


def reference_walk(gait: ReferenceGait) -> SimulatedWalk:
    """The gait over two and a half strides; forces are shared among the points that touch, not dynamically exact."""
    time, dense = (recording_time(gait.pattern, rate) for rate in (RATE, PLATE_RATE))
    return SimulatedWalk(
        subject=gait.subject,
        q=gait.coordinates(time),
        dense_q=gait.coordinates(dense),
        forces=_shared_forces(gait, dense),
        events=walk_events(gait.pattern),
        sole_changes=walk_sole_changes(gait.pattern),
    )


def walk_events(pattern: GaitPattern) -> tuple[Event, ...]:
    """Foot strikes and foot offs of a recording, times from its first frame, in time order."""
    found: list[Event] = []
    for side in SIDES:
        kinds: tuple[tuple[EventKind, float], ...] = (
            ("foot_strike", 0.0),
            ("foot_off", pattern.contacts[side].stance),
        )
        for kind, after in kinds:
            found += [
                Event(side=side, kind=kind, time=time, source="file") for time in _recorded_times(pattern, side, after)
            ]
    return tuple(sorted(found, key=lambda event: event.time))


def walk_sole_changes(pattern: GaitPattern) -> tuple[SoleChange, ...]:
    """Foot flats and heel offs of a recording, times from its first frame, in time order."""
    found: list[SoleChange] = []
    for side in SIDES:
        heel, toe = pattern.contacts[side].heel, pattern.contacts[side].toe
        kinds: tuple[tuple[SoleChangeKind, float], ...] = (("foot_flat", max(heel[0], toe[0])), ("heel_off", heel[1]))
        for kind, after in kinds:
            found += [SoleChange(side=side, kind=kind, time=time) for time in _recorded_times(pattern, side, after)]
    return tuple(sorted(found, key=lambda change: change.time))


def _recorded_times(pattern: GaitPattern, side: Side, after: float) -> list[float]:
    """Times from the first frame [s] of what happens so long [s] after each foot strike of a side."""
    time = recording_time(pattern, RATE)
    at = [pattern.delay(side) + after + k * pattern.stride_time for k in range(-2, 3)]
    return [t - float(time[0]) for t in at if time[0] < t < time[-1]]


def _shared_forces(gait: ReferenceGait, time: np.ndarray) -> dict[str, np.ndarray]:
    layout, p = layout_of(gait.subject), ca.SX(parameter_vector(gait.subject))
    q, v, a = (ca.SX.sym(name, layout.n_q) for name in "qva")
    function = ca.Function("needed", [q, v, a], [inverse_dynamics(layout, p, q, v, a, {})[:3]])
    total = np.array(function.map(len(time))(*[gait.coordinates(time, k).T for k in range(3)])).T
    shares = {name: _share(gait, name, time) for name in gait.subject.contacts}
    whole = sum(shares.values())
    return {name: total * (share / whole)[:, None] for name, share in shares.items()}


def _share(gait: ReferenceGait, name: str, time: np.ndarray) -> np.ndarray:
    """Load of a contact point beside others, which grows and falls at the ends of its contact; shape (n,)."""
    side: Side = "right" if name.startswith("right") else "left"
    start, end = getattr(gait.pattern.contacts[side], name.partition("_")[2])
    touches, stride = in_contact(gait.pattern, side, name.partition("_")[2], time)
    since = time - gait.pattern.delay(side) - start - stride * gait.pattern.stride_time
    left = end - start - since
    return np.where(touches, np.clip(np.minimum(since, left) / ROLLING, 0.0, 1.0), 0.0) + 1e-9 * touches
