"""The stages of a stride: which contact points carry force, how they land, what the forces may be.

A foot that is flat is a rigid body on two points: the distance between heel and toe makes the sixth of their
coordinates redundant, so the toe's component along the foot is left out, and the heel carries what friction there is in
this direction. Landings are soft by default: points come to rest as they touch (design/numerics.md, item 7). With
impacts they touch at any speed and are stopped within one short interval of its own, whose forces make up the impulse;
as that becomes shorter, the jump of the velocities goes to that of a rigid, inelastic impact, M (v+ - v-) = J' Lambda.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..errors import InvalidRecording, ProblemError
from ..ocp.mechanical import ContactStage
from .contact_phases import FLAT, FREE, HEEL, TOE
from .contact_timing import closest_stages, long_runs

Landing = Literal["soft", "impact"]

N_FORCES = 12
"""Force components 3 i + (x, y, z) of the points i in `model.POINTS`."""

Z = 2


@dataclass(frozen=True, kw_only=True)
class ScheduleSettings:
    """How finely the stride is cut."""

    interval: float = 0.02
    """Length of an interval [s]."""
    shortest: int = 2
    """Fewest intervals of a stage."""
    friction: float = 0.8
    """Coefficient of friction of shoe or skin on a laboratory's floor, dry."""
    landing: Landing = "soft"
    """Whether points come to rest before they touch ("soft") or by the force of the floor ("impact")."""
    impact_time: float = 0.004
    """Duration of an impact [s]."""
    shortest_flight: float = 0.06
    """Both feet in the air for less than this [s] is an error of the events, for more it is running."""
    longest_flight: float = 0.25
    """Both feet in the air for longer than this [s] is a stance whose events are missing."""


DEFAULTS = ScheduleSettings()


@dataclass(frozen=True, kw_only=True)
class _Foot:
    """One foot during one stage."""

    state: str
    offset: int
    """First of its six components: 0 right, 6 left."""
    along: int
    """Axis, 0 or 1, that is closer to the foot's direction."""

    @property
    def points(self) -> tuple[int, ...]:
        """Points in contact: 0 heel, 1 toe."""
        return {FREE: (), HEEL: (0,), FLAT: (0, 1), TOE: (1,)}[self.state]

    def components(self, point: int, axes: Sequence[int] = (0, 1, 2)) -> list[int]:
        """Indices of components of a point."""
        return [self.offset + 3 * point + axis for axis in axes]

    def active(self) -> list[int]:
        """Independent components of the points in contact."""
        across = [axis for axis in (0, 1, 2) if axis != self.along]
        if self.state == FLAT:
            return self.components(0) + self.components(1, across)
        return [i for point in self.points for i in self.components(point)]

    def touching(self, before: "_Foot | None") -> tuple[int, ...]:
        """Points that come into contact."""
        held = before.points if before is not None else ()
        return tuple(point for point in self.points if point not in held)

    def landing(self, before: "_Foot | None") -> list[int]:
        """Components that come to rest; the component along the foot does by itself when the other point is held."""
        new = self.touching(before)
        if len(new) < len(self.points):
            return [i for point in new for i in self.components(point) if i % 3 != self.along]
        return self.active() if new else []

    def heights(self, points: Sequence[int]) -> list[int]:
        """Height components of points."""
        return [self.offset + 3 * point + Z for point in points]

    def cone(self, friction: float) -> list[np.ndarray]:
        """Rows of the force cone, each of shape (12,).

        f_z >= 0 at each point. |f_across| <= c f_z at each point and |sum f_along| <= c sum f_z over the foot, which
        carries it at one point only, with c = friction / sqrt(2): the pyramid inscribed in the cone of friction.
        """
        c = float(friction / np.sqrt(2.0))
        upright = self.heights(self.points)
        across = [i - Z + 1 - self.along for i in upright]
        along = [i for i in self.active() if i % 3 == self.along]
        rows = [_row({z: 1.0}) for z in upright]
        for sign in (1.0, -1.0):
            rows += [_row({z: c, i: sign}) for z, i in zip(upright, across, strict=True)]
            if along:
                rows.append(_row({**dict.fromkeys(upright, c), **dict.fromkeys(along, sign)}))
        return rows


def contact_stages(
    phases: np.ndarray,
    rate: float,
    stride: tuple[float, float],
    settings: ScheduleSettings = DEFAULTS,
    directions: tuple[float, float] = (0.0, 0.0),
) -> tuple[ContactStage, ...]:
    """Stages of constant contact of one stride, labelled "right-left", for instance "flat-free".

    Args:
        phases: State of the right and the left foot in every frame, see `contact_phases`, shape (n_frames, 2).
        rate: Frames per second [Hz].
        stride: Start and end [s] from the first stored frame.
        settings: How finely to cut.
        directions: Direction of the right and the left standing foot about z from x (forward) [rad]; beyond 45 degrees
            the toe's y takes the part of its x. See `contact_phases.foot_directions`.

    Raises:
        InvalidRecording: The stride is not within the frames, too short for a stage, or a stance is missing in it.
    """
    first, last = _frames(len(phases), rate, stride, settings)
    _check_flight(phases[first:last], rate, stride, settings)
    cut = closest_stages(phases[first:last], _shortest(rate, settings), _at_least(settings.shortest_flight * rate))
    along = [int(abs(np.sin(angle)) > abs(np.cos(angle))) for angle in directions]
    stages: list[ContactStage] = []
    before: list[_Foot | None] = [None, None]
    for states, n_frames in cut:
        feet = [_Foot(state=s, offset=6 * k, along=along[k]) for k, s in enumerate(states)]
        duration = n_frames / rate
        n_intervals = max(settings.shortest, round(duration / settings.interval))
        stage = _stage(feet, before, duration, n_intervals, settings.friction)
        stages += _with_impact(stage, settings.impact_time) if settings.landing == "impact" else [stage]
        before = [*feet]
    return tuple(stages)


def _with_impact(stage: ContactStage, time: float) -> list[ContactStage]:
    """The stage with its landing as a short stage of one interval; as it is where nothing lands."""
    if not stage.landing:
        return [stage]
    impact = replace(stage, duration=time, n_intervals=1, landing=(), label=f"{stage.label} (impact)")
    return [impact, replace(stage, duration=stage.duration - time, landing=(), grounded=())]


def thesis_stages(
    durations: tuple[float, float, float], n_intervals: tuple[int, int, int], friction: float = DEFAULTS.friction
) -> tuple[ContactStage, ...]:
    """The thesis's point feet: single support on the right, the left and the right toe.

    Its two stages of no duration are impacts; a `ContactStage` has none, so the toe lands softly here, as it does in
    every other stage. The feet have no heel: heels may pass through the floor.

    Args:
        durations: Of the three single supports [s].
        n_intervals: Intervals of each.
        friction: Coefficient of friction.
    """
    if len(durations) != 3 or len(n_intervals) != 3:
        raise ProblemError(
            f"the point-foot gait has three single supports; got {len(durations)} durations and "
            f"{len(n_intervals)} numbers of intervals"
        )
    stages: list[ContactStage] = []
    before: list[_Foot | None] = [None, None]
    for states, duration, n in zip(((TOE, FREE), (FREE, TOE), (TOE, FREE)), durations, n_intervals, strict=True):
        feet = [_Foot(state=state, offset=6 * k, along=0) for k, state in enumerate(states)]
        stages.append(_stage(feet, before, duration, n, friction, free_points=(1,)))
        before = [*feet]
    return tuple(stages)


def _stage(
    feet: Sequence[_Foot],
    before: Sequence[_Foot | None],
    duration: float,
    n_intervals: int,
    friction: float,
    free_points: Sequence[int] = (0, 1),
) -> ContactStage:
    cone = [row for foot in feet for row in foot.cone(friction)]
    pairs = list(zip(feet, before, strict=True))
    return ContactStage(
        duration=duration,
        n_intervals=n_intervals,
        active=tuple(i for foot in feet for i in foot.active()),
        landing=tuple(i for foot, last in pairs for i in foot.landing(last)),
        grounded=tuple(i for foot, last in pairs for i in foot.heights(foot.touching(last))),
        clear=tuple(i for foot in feet for i in foot.heights([p for p in free_points if p not in foot.points])),
        force_cone=np.array(cone).reshape(-1, N_FORCES),
        data=np.array([float(foot.state != FREE) for foot in feet]),
        label="-".join(foot.state for foot in feet),
    )


def _row(entries: Mapping[int, float]) -> np.ndarray:
    row = np.zeros(N_FORCES)
    row[list(entries)] = list(entries.values())
    return row


def _frames(n_frames: int, rate: float, stride: tuple[float, float], settings: ScheduleSettings) -> tuple[int, int]:
    """First frame of the stride and the one where it ends."""
    first, last = round(stride[0] * rate), round(stride[1] * rate)
    if first < 0 or last > n_frames - 1:
        raise InvalidRecording(
            f"the stride at {stride[0]:.2f}-{stride[1]:.2f} s is not within the {n_frames} frames of the trial "
            f"(0-{(n_frames - 1) / rate:.2f} s); choose a full stride of this trial"
        )
    if last - first < _shortest(rate, settings):
        raise InvalidRecording(
            f"the stride at {stride[0]:.2f}-{stride[1]:.2f} s is too short for a stage of {settings.shortest} "
            f"intervals of {settings.interval:g} s; a stride goes from a foot strike to the next one of the same foot"
        )
    return first, last


def _check_flight(phases: np.ndarray, rate: float, stride: tuple[float, float], settings: ScheduleSettings) -> None:
    flight = long_runs((phases == FREE).all(axis=1), _at_least(settings.longest_flight * rate))
    if flight.any():
        raise InvalidRecording(
            f"in the stride at {stride[0]:.2f}-{stride[1]:.2f} s no foot stands from "
            f"{stride[0] + np.argmax(flight) / rate:.2f} s on for more than {settings.longest_flight:g} s: a foot "
            "strike is missing; let the events be detected again or choose another stride"
        )


def _shortest(rate: float, settings: ScheduleSettings) -> int:
    """Fewest frames of a stage."""
    return _at_least(settings.shortest * settings.interval * rate)


def _at_least(frames: float) -> int:
    """A number of frames rounded up, but for rounding errors."""
    return max(1, int(np.ceil(frames - 1e-6)))
