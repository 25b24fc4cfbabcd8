"""The reference gait as a walk: its coordinates, its events, and ground forces that roughly carry it."""

import casadi as ca
import numpy as np

from ..mocap.recording import Event, EventKind, Side
from ..multibody.dynamics import inverse_dynamics, layout_of, parameter_vector
from .demo_gait import ReferenceGait, in_contact
from .demo_patterns import SIDES
from .demo_recording import PLATE_RATE, RATE, SimulatedWalk

BEFORE, AFTER = 0.75, 1.75
"""First and last moment of a recording, in strides after the right foot strike at time 0."""
ROLLING = 0.04  # [s], in which load moves from one contact point to the next


def reference_walk(gait: ReferenceGait) -> SimulatedWalk:
    """The gait over two and a half strides; forces are shared among the points that touch, not dynamically exact."""
    period = gait.pattern.stride_time
    n = int((BEFORE + AFTER) * period * RATE)
    time, dense = (np.arange(count) / rate - BEFORE * period for count, rate in ((n, RATE), (10 * n, PLATE_RATE)))
    return SimulatedWalk(
        subject=gait.subject,
        q=gait.coordinates(time),
        dense_q=gait.coordinates(dense),
        forces=_shared_forces(gait, dense),
        events=walk_events(gait, n / RATE),
    )


def walk_events(gait: ReferenceGait, duration: float) -> tuple[Event, ...]:
    """Foot strikes and foot offs within `duration` [s] from the first frame, in time order."""
    pattern, found = gait.pattern, list[Event]()
    for side in SIDES:
        kinds: tuple[tuple[EventKind, float], ...] = (
            ("foot_strike", 0.0),
            ("foot_off", pattern.contacts[side].stance),
        )
        for kind, share in kinds:
            for k in range(-3, 3):
                time = pattern.stride_time * (BEFORE + pattern.delay(side) + share + k)
                if 0.0 < time < duration - 1.0 / RATE:
                    found.append(Event(side=side, kind=kind, time=time, source="file"))
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
    period = gait.pattern.stride_time
    start, end = getattr(gait.pattern.contacts[side], name.partition("_")[2])
    touches, stride = in_contact(gait.pattern, side, name.partition("_")[2], time / period)
    since = time - period * (gait.pattern.delay(side) + start + stride)
    left = period * (end - start) - since
    return np.where(touches, np.clip(np.minimum(since, left) / ROLLING, 0.0, 1.0), 0.0) + 1e-9 * touches
