"""The reference gait as a walk: its coordinates, its events, and ground forces that roughly carry it."""

import casadi as ca
import numpy as np

from ..mocap.recording import Event, EventKind, Side
from ..multibody.dynamics import inverse_dynamics, layout_of, parameter_vector
from .demo_gait import ReferenceGait, in_contact
from .demo_patterns import SIDES, GaitPattern
from .demo_recording import PLATE_RATE, RATE, SimulatedWalk

BEFORE, AFTER = 0.24, 0.32
"""A recording begins so long [s] before a left strike, and ends so long after the left strike two strides later."""
ROLLING = 0.04  # [s], in which load moves from one contact point to the next


def recording_time(pattern: GaitPattern, rate: float) -> np.ndarray:
    """Times of samples at a rate [Hz], 0 at the right foot strike in the recording, shape (n,) [s]."""
    first, last = -pattern.stride_time / 2 - BEFORE, 1.5 * pattern.stride_time + AFTER
    return first + np.arange(round((last - first) * rate) + 1) / rate


def reference_walk(gait: ReferenceGait) -> SimulatedWalk:
    """The gait over two and a half strides; forces are shared among the points that touch, not dynamically exact."""
    time, dense = (recording_time(gait.pattern, rate) for rate in (RATE, PLATE_RATE))
    return SimulatedWalk(
        subject=gait.subject,
        q=gait.coordinates(time),
        dense_q=gait.coordinates(dense),
        forces=_shared_forces(gait, dense),
        events=walk_events(gait.pattern),
    )


def walk_events(pattern: GaitPattern) -> tuple[Event, ...]:
    """Foot strikes and foot offs of a recording, times from its first frame, in time order."""
    time, found = recording_time(pattern, RATE), list[Event]()
    for side in SIDES:
        kinds: tuple[tuple[EventKind, float], ...] = (
            ("foot_strike", 0.0),
            ("foot_off", pattern.contacts[side].stance),
        )
        for kind, after in kinds:
            for k in range(-2, 3):
                at = pattern.delay(side) + after + k * pattern.stride_time
                if time[0] < at < time[-1]:
                    found.append(Event(side=side, kind=kind, time=at - time[0], source="file"))
    return tuple(sorted(found, key=lambda event: event.time))


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
