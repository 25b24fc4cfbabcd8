"""The movement analysis profile: bars of the gait variable scores, left and right, and the gait profile scores."""

from collections.abc import Mapping

from ..clinical.gait_profile import GPS_MINIMAL_DIFFERENCE, VARIABLES
from .colours import CENTRE, SIDE
from .svg import Axes, figure, frame, rectangle, straight, text

_WIDTH, _BAR = 1000.0, 26.0
HIGHEST = 30.0
"""Upper end of the fixed scale [deg]."""
_SHORT = {
    "pelvis_tilt": "Pel tilt",
    "pelvis_obliquity": "Pel obl",
    "pelvis_rotation": "Pel rot",
    "hip_flexion": "Hip flex",
    "hip_adduction": "Hip add",
    "hip_rotation": "Hip rot",
    "knee_flexion": "Knee flex",
    "ankle_dorsiflexion": "Ank dors",
    "foot_progression": "Foot prog",
}


def profile_figure(
    profiles: Mapping[str, Mapping[str, float]], totals: Mapping[str, float | None], cohort: Mapping[str, float]
) -> str:
    """Draw the profile.

    Args:
        profiles: Gait variable scores [deg] of each side.
        totals: Gait profile scores [deg] of `left`, `right` and `overall`.
        cohort: Mean scores of the reference cohort's own persons [deg], by variable and `gps`; may be empty.
    """
    n = len(VARIABLES) + 1
    axes = Axes(left=66.0, top=62.0, width=920.0, height=190.0, x_range=(0.0, float(n)), y_range=(0.0, HIGHEST))
    parts = [
        frame(axes, (), (0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0)),
        text("GVS and GPS [deg], smaller is closer to the reference", 66.0, 24.0, **{"class": "note"}),
    ]
    for place, name in enumerate(VARIABLES):
        values = {side: scores.get(name) for side, scores in profiles.items()}
        parts.append(_column(axes, place, _SHORT[name], values, cohort.get(name)))
    parts.append(_column(axes, n - 1, "GPS", totals, cohort.get("gps")))
    parts.append(_key(axes, bool(cohort)))
    return figure(_WIDTH, axes.bottom + 50.0, "".join(parts), "Movement analysis profile")


def _column(axes: Axes, place: int, name: str, values: Mapping[str, float | None], cohort: float | None) -> str:
    middle = axes.x(place + 0.5)
    known = [(who, value) for who, value in values.items() if value is not None]
    start = middle - _BAR * len(values) / 2.0
    parts = [text(name, middle, axes.bottom + 17.0, **{"class": "label", "text_anchor": "middle"})]
    if cohort is not None:
        top = axes.y(min(cohort, HIGHEST))
        parts.append(rectangle(axes.x(place + 0.04), top, axes.x(0.92) - axes.left, axes.bottom - top, fill="#d3d8dd"))
    for who, value in known:
        x = start + _BAR * list(values).index(who)
        top = axes.y(min(value, HIGHEST))
        colour = SIDE.get(who, CENTRE)
        parts.append(rectangle(x + 2.0, top, _BAR - 4.0, axes.bottom - top, fill=colour))
        # A number with an arrow is wider than its bar: it stands a line higher than its neighbours.
        words, above = (f"{value:.1f}↑", 17.0) if value > HIGHEST else (f"{value:.1f}", 4.0)
        place_of = {"class": "tick", "text_anchor": "middle"}
        parts.append(text(words, x + _BAR / 2.0, top - above, **place_of))
    if not known:
        parts.append(text("–", middle, axes.bottom - 6.0, **{"class": "note", "text_anchor": "middle"}))
    return "".join(parts)


def _key(axes: Axes, with_cohort: bool) -> str:
    parts = list[str]()
    words = [(side, colour) for side, colour in SIDE.items()] + [("overall", CENTRE)]
    words += [("mean of the cohort's own persons", "#d3d8dd")] if with_cohort else []
    for index, (name, colour) in enumerate(words):
        x = axes.left + 90.0 * index
        parts.append(rectangle(x, axes.bottom + 30.0, 14.0, 10.0, fill=colour))
        parts.append(text(name, x + 19.0, axes.bottom + 39.5, **{"class": "label"}))
    span = axes.y(0.0) - axes.y(GPS_MINIMAL_DIFFERENCE)
    x, base = axes.right - 420.0, axes.bottom + 42.0
    parts.append(straight((x, base), (x, base - span), stroke="#222", stroke_width=3.0))
    least = f"height of the minimal clinically important difference: {GPS_MINIMAL_DIFFERENCE:g} deg"
    return "".join(parts) + text(least, x + 8.0, axes.bottom + 39.5, **{"class": "note"})
