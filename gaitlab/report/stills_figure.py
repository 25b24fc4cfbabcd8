"""Stills of the walk: the measured skeleton and the model-optimal one over it, at the moments that divide a stride."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..mocap.cycle import Cycle
from ..mocap.recording import Side
from .colours import CENTRE, SIDE, side_of
from .svg import figure, number, straight, text
from .walk_figure import heading
from .walk_file import Walk

_WIDTH, _LEFT, _TOP = 1000.0, 66.0, 52.0
_METRE = 195.0
"""Length of one metre on the figure; fixed, so that people can be compared."""
_RISE = np.radians(15.0)
"""Height of the eye in the oblique view [rad]."""
OPTIMAL = "#111111"
OBLIQUE = "oblique"
OPPOSITE: Mapping[Side, Side] = {"left": "right", "right": "left"}


@dataclass(frozen=True, kw_only=True)
class Moment:
    """One still."""

    name: str
    time: float
    """From the first stored frame [s]."""
    percent: float
    """Of the cycle."""


@dataclass(frozen=True, kw_only=True)
class _Skeleton:
    """One person at one instant."""

    points: np.ndarray
    """Joints on the plane of the view [m], shape (n_points, 2)."""
    bones: np.ndarray
    """Pairs of rows of `points`, shape (n_bones, 2)."""
    sides: tuple[str | None, ...]
    """Of each bone."""


def stride_moments(cycle: Cycle) -> tuple[Moment, ...]:
    """Foot strike, opposite foot off, mid-stance, opposite foot strike, foot off, mid-swing, those that are known."""
    side, other = cycle.side, OPPOSITE[cycle.side]
    middle = _middle(cycle.opposite_foot_off, cycle.opposite_foot_strike)
    known = {
        f"{side} foot strike": cycle.start,
        f"{other} foot off": cycle.opposite_foot_off,
        f"{side} mid-stance": middle,
        f"{other} foot strike": cycle.opposite_foot_strike,
        f"{side} foot off": cycle.foot_off,
        f"{side} mid-swing": _middle(cycle.foot_off, cycle.end),
    }
    found = sorted((time, name) for name, time in known.items() if time is not None)
    return tuple(Moment(name=n, time=t, percent=100.0 * (t - cycle.start) / cycle.duration) for t, n in found)


def _middle(start: float | None, end: float | None) -> float | None:
    return None if start is None or end is None else 0.5 * (start + end)


def stills_figure(walk: Walk, moments: Sequence[Moment]) -> str | None:
    """Draw rows sagittal, frontal and oblique, a column per moment; None without a measured skeleton and its bones."""
    measured, bones = walk.vectors("segment_positions_measured"), walk.arrays.get("bones")
    if measured is None or bones is None or bones.ndim != 2 or not moments or bones.max() >= measured.shape[1]:
        return None
    optimal = walk.vectors("segment_positions_optimal")
    names = walk.names("segment_names")
    sides = tuple(side_of(names[child]) if child < len(names) else None for _, child in bones)
    width = (_WIDTH - _LEFT) / len(moments)
    height = float(np.ptp(measured[:, :, 2][np.isfinite(measured[:, :, 2])])) * _METRE + 26.0
    parts = [_legend(optimal is not None)]
    for row, (view, axes) in enumerate(_views(heading(walk)).items()):
        floor = _TOP + (row + 1) * height + 4.0 * row
        x = 20.0
        turned = {"class": "heading", "text_anchor": "middle"}
        middle = floor - 0.45 * height
        parts.append(text(view, x, middle, transform=f"rotate(-90 {number(x)} {number(middle)})", **turned))
        if view != OBLIQUE:
            parts.append(straight((_LEFT, floor - 8.0), (_WIDTH, floor - 8.0), **{"class": "axis"}))
        for column, moment in enumerate(moments):
            frame = int(np.argmin(np.abs(walk.time - moment.time)))
            origin = np.append(measured[frame, 0, :2], float(np.nanmin(measured[:, :, 2])))
            place = (_LEFT + (column + 0.5) * width, floor - 8.0)
            for positions, style in ((measured, _bones_measured), (optimal, _bones_optimal)):
                if positions is not None:
                    flat = (positions[frame] - origin) @ axes.T
                    parts.append(style(_Skeleton(points=flat, bones=bones, sides=sides), place))
    bottom = _TOP + 3 * height + 12.0
    parts += [_caption(moment, _LEFT + (k + 0.5) * width, bottom + 14.0) for k, moment in enumerate(moments)]
    return figure(_WIDTH, bottom + 40.0, "".join(parts), "Stills of the measured and the model-optimal walk")


def _views(forward: np.ndarray) -> dict[str, np.ndarray]:
    """Axes to the right and up of each view, shape (2, 3), from the walking direction."""
    up = np.array([0.0, 0.0, 1.0])
    left = np.cross(up, forward)
    slant = (forward + left) / np.sqrt(2.0)
    into = (left - forward) / np.sqrt(2.0)
    return {
        "from the right": np.stack([forward, up]),
        "from ahead": np.stack([left, up]),
        OBLIQUE: np.stack([slant, np.cos(_RISE) * up + np.sin(_RISE) * into]),
    }


def _ends(skeleton: _Skeleton, place: tuple[float, float]) -> list[tuple[tuple[float, float], ...] | None]:
    """Both ends of each bone on the figure; None where one is unknown."""
    x0, y0 = place
    at = skeleton.points * (_METRE, -_METRE) + (x0, y0)
    pairs = [(at[a], at[b]) for a, b in skeleton.bones]
    return [
        tuple((float(p[0]), float(p[1])) for p in pair) if np.isfinite(np.concatenate(pair)).all() else None
        for pair in pairs
    ]


def _bones_measured(skeleton: _Skeleton, place: tuple[float, float]) -> str:
    parts = list[str]()
    for ends, side in zip(_ends(skeleton, place), skeleton.sides, strict=True):
        if ends is not None:
            colour = CENTRE if side is None else SIDE[side]
            style = {"stroke": colour, "stroke_width": 4.5, "stroke_linecap": "round", "opacity": "0.75"}
            parts.append(straight(ends[0], ends[1], **style))
    return "".join(parts) + _letters(skeleton, place)


def _letters(skeleton: _Skeleton, place: tuple[float, float]) -> str:
    """L and R at the tips of the feet, so that the sides can be told without colour."""
    parents = set(skeleton.bones[:, 0].tolist())
    parts = list[str]()
    for (_, child), ends, side in zip(skeleton.bones, _ends(skeleton, place), skeleton.sides, strict=True):
        if ends is not None and side is not None and int(child) not in parents:
            x, y = ends[1]
            raised = 10.0 if side == "left" else -2.0  # so that both can be read where one foot passes the other
            parts.append(text(side[0].upper(), x + 3.0, y - raised, fill=SIDE[side], **{"class": "title"}))
    return "".join(parts)


def _bones_optimal(skeleton: _Skeleton, place: tuple[float, float]) -> str:
    style = {"stroke": OPTIMAL, "stroke_width": 1.6, "stroke_dasharray": "5 2.5"}
    return "".join(straight(ends[0], ends[1], **style) for ends in _ends(skeleton, place) if ends is not None)


def _caption(moment: Moment, x: float, y: float) -> str:
    middle = {"text_anchor": "middle"}
    return text(moment.name, x, y, **{"class": "title"}, **middle) + text(
        f"{moment.percent:.0f} % of cycle, {moment.time:.2f} s", x, y + 16.0, **{"class": "note"}, **middle
    )


def _legend(with_optimum: bool) -> str:
    parts, x = list[str](), _LEFT
    entries: list[tuple[str, dict[str, object]]] = [
        (f"measured, {side}", {"stroke": colour, "stroke_width": 4.5, "opacity": "0.75"})
        for side, colour in SIDE.items()
    ]
    if with_optimum:
        entries.append(("model-optimal", {"stroke": OPTIMAL, "stroke_width": 1.6, "stroke_dasharray": "5 2.5"}))
    for words, style in entries:
        parts.append(straight((x, 16.0), (x + 30.0, 16.0), **style))
        parts.append(text(words, x + 38.0, 20.0, **{"class": "label"}))
        x += 170.0
    parts.append(straight((x, 16.0), (x + 0.5 * _METRE, 16.0), stroke="#222", stroke_width=1.5))
    parts.append(text("0.5 m", x + 0.5 * _METRE + 8.0, 20.0, **{"class": "label"}))
    return "".join(parts)
