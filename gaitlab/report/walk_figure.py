"""Pictures of the walk in time: measured and model-optimal joint angles, contact forces beside the force plates."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .colours import CENTRE, DASH, SIDE, side_of
from .cycle_panels import leaves_scale, value_range
from .svg import Axes, clipped, curve, figure, frame, rectangle, straight, text, ticks
from .walk_file import Walk

GRAVITY = 9.81  # [m/s^2]
_WIDTH, _COLUMN, _PANEL, _TOP = 1000.0, 325.0, 250.0, 58.0
_JOINTS = {"pelvis": "Pelvis", "thigh": "Hip", "shank": "Knee", "foot": "Ankle", "trunk": "Trunk"}
_AXES = ("about y (sagittal)", "about x (frontal)", "about z (transverse)")
_SHADES = ("#eef1f4", "#ffffff")
_MODEL_DASH = {"left": "2 2", "right": "7 2 1.5 2", None: "2 2"}
"""Line style of the model's curves by side, different from the measured ones, so that no colour is needed."""
Range = tuple[float, float]
_PLANES: tuple[Range, Range, Range] = ((-50.0, 50.0), (-30.0, 30.0), (-40.0, 40.0))
_SAGITTAL: Mapping[str, Range] = {"Hip": (-70.0, 50.0), "Knee": (-20.0, 100.0)}
"""Fixed scales of the joints [deg]: sagittal, frontal, transverse, and where the first is another one."""
_FORCES: tuple[Range, Range, Range] = ((-20.0, 180.0), (-60.0, 60.0), (-40.0, 40.0))
"""Fixed scales of the forces [% of body weight]: vertical, fore-aft, lateral."""
_NEWTON = 6.0
"""The same where no mass is known, times this [N]."""


@dataclass(frozen=True, kw_only=True)
class Trace:
    """One line of a panel."""

    values: np.ndarray
    """Over time, unit of the panel, shape (n,)."""
    side: str | None
    """None for the middle."""
    modelled: bool = False

    @property
    def style(self) -> dict[str, object]:
        """Colour of the side, line style of side and kind."""
        colour = CENTRE if self.side is None else SIDE[self.side]
        measured = "none" if self.side is None else DASH[self.side]
        dash = _MODEL_DASH[self.side] if self.modelled else measured
        return {"stroke": colour, "stroke_width": 1.6 if self.modelled else 2.0, "stroke_dasharray": dash}


def modelled_part(walk: Walk) -> Walk:
    """The frames from the first to the last that the model explains; all of them if it explains none."""
    optimal = walk.numbers("q_optimal", 2)
    known = np.zeros(0, dtype=int) if optimal is None else np.flatnonzero(np.isfinite(optimal).all(axis=1))
    if known.size < 2:
        return walk
    part = slice(int(known[0]), int(known[-1]) + 1)
    n = len(walk.time)
    arrays = {name: a[part] if a.ndim > 0 and len(a) == n else a for name, a in walk.arrays.items()}
    return Walk(time=walk.time[part], arrays=arrays)


def joints_figure(walk: Walk) -> str | None:
    """Draw measured (solid) and model-optimal (dashed) joint coordinates [deg]; None without `q_measured`."""
    measured, optimal = walk.numbers("q_measured", 2), walk.numbers("q_optimal", 2)
    if measured is None or measured.shape[1] < 6:
        return None
    rows = _joint_rows(walk.names("segment_names"), measured.shape[1])
    parts = list[str]()
    for row, (title, segments) in enumerate(rows):
        for axis, words in enumerate(_AXES):
            columns = [(side, 3 + 3 * index + axis) for side, index in segments]
            traces = [_trace(measured, column, side, False) for side, column in columns]
            if optimal is not None and optimal.shape == measured.shape:
                traces += [_trace(optimal, column, side, True) for side, column in columns]
            scale = _SAGITTAL.get(title, _PLANES[0]) if axis == 0 else _PLANES[axis]
            axes = _axes(walk.time, (row, axis), scale, 115.0, 166.0)
            parts.append(_panel(walk, axes, traces, f"{title} {words} [deg]"))
    legend = _legend("measured", "model-optimal")
    height = _TOP + 166.0 * len(rows) + 14.0
    return figure(_WIDTH, height, legend + "".join(parts), "Measured and model-optimal joint angles")


def _joint_rows(names: Sequence[str], n_q: int) -> list[tuple[str, list[tuple[str | None, int]]]]:
    """Joints in order of appearance: title, then side and segment index of each segment it carries."""
    rows = dict[str, list[tuple[str | None, int]]]()
    n_segments = n_q // 3 - 1
    for index in range(n_segments):
        name = names[index] if index < len(names) else f"segment {index + 1}"
        side = side_of(name)
        stem = name if side is None else name[len(side) + 1 :]
        rows.setdefault(_JOINTS.get(stem, stem.replace("_", " ").capitalize()), []).append((side, index))
    return list(rows.items())


def _trace(q: np.ndarray, column: int, side: str | None, modelled: bool) -> Trace:
    return Trace(values=np.degrees(q[:, column]), side=side, modelled=modelled)


def forces_figure(walk: Walk, mass: float | None) -> str | None:
    """Draw contact forces of the model per foot (dashed) beside the plates (solid); None if there is neither.

    Forces are in % of body weight where the mass [kg] is known, otherwise in N. Forward is the way of the pelvis.
    """
    model, plates = walk.vectors("forces_optimal"), walk.vectors("grf_plates")
    if model is None and plates is None:
        return None
    unit, factor = ("N", 1.0) if not mass else ("% body weight", 100.0 / (mass * GRAVITY))
    forward = heading(walk)
    left = np.array([-forward[1], forward[0], 0.0])
    parts = list[str]()
    directions = (
        ("Vertical (up +)", np.array([0.0, 0.0, 1.0])),
        ("Fore-aft (forward +)", forward),
        ("Lateral (left +)", left),
    )
    for column, (title, direction) in enumerate(directions):
        traces = _plate_traces(plates, direction * factor)
        traces += _model_traces(model, walk.names("contact_names"), direction * factor)
        low, high = (end * (1.0 if mass else _NEWTON) for end in _FORCES[column])
        axes = _axes(walk.time, (0, column), (low, high), 170.0, 170.0)
        parts.append(_panel(walk, axes, traces, f"{title} [{unit}]"))
    legend = _forces_legend()
    return figure(_WIDTH, _TOP + 170.0 + 40.0, legend + "".join(parts), "Contact forces of the model and of the plates")


def heading(walk: Walk) -> np.ndarray:
    """Unit vector of the walking direction on the floor, from the way of the pelvis, shape (3,); x if unknown."""
    positions = walk.vectors("segment_positions_measured")
    positions = walk.vectors("segment_positions_optimal") if positions is None else positions
    if positions is None:
        return np.array([1.0, 0.0, 0.0])
    root = positions[np.all(np.isfinite(positions[:, 0]), axis=1), 0]
    way = np.append(root[-1, :2] - root[0, :2], 0.0) if len(root) > 1 else np.zeros(3)
    length = float(np.linalg.norm(way))
    return way / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])


def _plate_traces(plates: np.ndarray | None, direction: np.ndarray) -> list[Trace]:
    if plates is None:
        return []
    return [Trace(values=plates[:, k] @ direction, side=None) for k in range(plates.shape[1])]


def _model_traces(model: np.ndarray | None, names: Sequence[str], direction: np.ndarray) -> list[Trace]:
    if model is None:
        return []
    sides = [side_of(name) for name in names] + [None] * model.shape[1]
    traces = list[Trace]()
    for side in dict.fromkeys(sides[: model.shape[1]]):
        chosen = [k for k in range(model.shape[1]) if sides[k] == side]
        traces.append(Trace(values=model[:, chosen].sum(axis=1) @ direction, side=side, modelled=True))
    return traces


def _axes(time: np.ndarray, place: tuple[int, int], scale: Range, height: float, pitch: float) -> Axes:
    row, column = place
    last = float(time[-1]) if time[-1] > time[0] else float(time[0]) + 1.0
    corner = {"left": 50.0 + _COLUMN * column, "top": _TOP + pitch * row}
    return Axes(**corner, width=_PANEL, height=height, x_range=(float(time[0]), last), y_range=scale)


def _panel(walk: Walk, axes: Axes, traces: Sequence[Trace], title: str) -> str:
    lines = [curve(axes, walk.time, trace.values, **trace.style) for trace in traces]
    return (
        _phases(walk, axes)
        + frame(axes, ticks(*axes.x_range, 5), ticks(*axes.y_range, 4))
        + clipped(axes, "".join(lines))
        + text(title, axes.left, axes.top - 7.0, **{"class": "title"})
        + text("[s]", axes.right + 12.0, axes.bottom + 15.0, **{"class": "tick"})
        + leaves_scale(axes, value_range([trace.values for trace in traces]), 0)
    )


def _legend(measured: str, modelled: str) -> str:
    entries = [
        (f"{words}, {side}", Trace(values=np.zeros(0), side=side, modelled=model))
        for words, model in ((measured, False), (modelled, True))
        for side in SIDE
    ]
    return _keys(entries)


def _forces_legend() -> str:
    none = np.zeros(0)
    entries = [(f"model, sum over the {side} foot", Trace(values=none, side=side, modelled=True)) for side in SIDE]
    return _keys([("force plates", Trace(values=none, side=None)), *entries])


def _keys(entries: Sequence[tuple[str, Trace]]) -> str:
    parts, x = list[str](), 50.0
    for words, trace in entries:
        parts.append(straight((x, 15.0), (x + 36.0, 15.0), **trace.style))
        parts.append(text(words, x + 44.0, 19.5, **{"class": "label"}))
        x += 70.0 + 8.5 * len(words)
    return "".join(parts)


def phase_spans(walk: Walk) -> list[tuple[str, float, float]]:
    """Name, start and end [s] of each phase, in order; empty without `phase`."""
    phase = walk.get("phase")
    if phase is None or phase.ndim != 1:
        return []
    words = [str(word) for word in phase]
    starts = [0, *(k for k in range(1, len(words)) if words[k] != words[k - 1])]
    ends = [*starts[1:], len(words) - 1]
    return [(words[a], float(walk.time[a]), float(walk.time[b])) for a, b in zip(starts, ends, strict=True) if b > a]


def _phases(walk: Walk, axes: Axes) -> str:
    parts = list[str]()
    for index, (_, start, end) in enumerate(phase_spans(walk)):
        x, width = axes.x(start), axes.x(end) - axes.x(start)
        parts.append(rectangle(x, axes.top, width, axes.height, fill=_SHADES[index % 2]))
        if index:
            parts.append(straight((x, axes.top), (x, axes.bottom), **{"class": "grid"}))
    return "".join(parts)
