"""The kinetics page: moments, powers and ground reactions over the gait cycle, columns hip, knee, ankle.

Scales are always the same, so that pages can be compared by eye; a curve that leaves its scale is cut off and told.
"""

from collections.abc import Mapping
from dataclasses import replace

from .cycle_panels import (
    EVERY_CYCLE,
    CurveSets,
    CyclePanel,
    CycleSets,
    Marks,
    averages,
    cycle_lines,
    cycle_panel,
    every_range,
    legend,
    legend_lines,
    mean_range,
)
from .kinematics_figure import NO_NORMS, Norms, norm_band, norm_legend
from .svg import Axes, figure

_WIDTH, _COLUMN, _ROW = 1000.0, 325.0, 190.0
_TOP, _PANEL_WIDTH, _PANEL_HEIGHT = 26.0, 245.0, 128.0
_LEGEND = 150.0
Range = tuple[float, float]


def _panels(row: int, kinds: tuple[tuple[str, Range, str, str], ...]) -> tuple[CyclePanel, ...]:
    """One row of three panels: name, scale, title and direction of each."""
    return tuple(
        CyclePanel(
            name=name,
            title=title,
            axes=Axes(
                left=66.0 + column * _COLUMN,
                top=_TOP + row * _ROW,
                width=_PANEL_WIDTH,
                height=_PANEL_HEIGHT,
                x_range=(0.0, 100.0),
                y_range=scale,
            ),
            direction=direction,
            x_label=row == len(_SCALES) - 1,
            decimals=0 if name.startswith("ground_reaction") else 2,
        )
        for column, (name, scale, title, direction) in enumerate(kinds)
    )


_SCALES: tuple[tuple[tuple[str, Range, str, str], ...], ...] = (
    (
        ("hip_extensor_moment", (-2.0, 2.0), "Hip moment, sagittal, internal", "Flexor / Extensor [N·m/kg]"),
        ("knee_extensor_moment", (-1.5, 2.0), "Knee moment, sagittal, internal", "Flexor / Extensor [N·m/kg]"),
        ("ankle_plantarflexor_moment", (-1.0, 2.5), "Ankle moment, sagittal, internal", "Dorsi / Plantar [N·m/kg]"),
    ),
    (
        ("hip_abductor_moment", (-1.0, 1.5), "Hip moment, frontal, internal", "Adductor / Abductor [N·m/kg]"),
        ("knee_abductor_moment", (-1.0, 1.0), "Knee moment, frontal, internal", "Adductor / Abductor [N·m/kg]"),
        ("ankle_evertor_moment", (-0.5, 0.5), "Ankle moment, frontal, internal", "Invertor / Evertor [N·m/kg]"),
    ),
    (
        ("hip_power", (-3.0, 4.0), "Hip power", "Absorbed / Generated [W/kg]"),
        ("knee_power", (-4.0, 3.0), "Knee power", "Absorbed / Generated [W/kg]"),
        ("ankle_power", (-3.0, 6.0), "Ankle power", "Absorbed / Generated [W/kg]"),
    ),
    (
        ("ground_reaction_vertical", (0.0, 150.0), "Ground reaction, vertical", "Up [% body weight]"),
        ("ground_reaction_forward", (-40.0, 40.0), "Ground reaction, fore-aft", "Back / Forward [% BW]"),
        ("ground_reaction_medial", (-20.0, 20.0), "Ground reaction, sideways", "Lateral / Medial [% BW]"),
    ),
)
PANELS = tuple(panel for row, kinds in enumerate(_SCALES) for panel in _panels(row, kinds))


def kinetics_figure(kinetics: CurveSets, marks: Mapping[str, Marks], norms: Norms = NO_NORMS) -> str:
    """Draw the mean of each side, with a band of one standard deviation where there are two cycles or more.

    `norms` may hold bands of these curves among others; they are drawn grey.
    """
    drawn = {p.name: averages(p.axes, kinetics.get(p.name, {})) for p in PANELS}
    extents = {p.name: mean_range(kinetics.get(p.name, {})) for p in PANELS}
    words = "mean of the cycles with a valid plate contact, coloured band: ± 1 standard deviation; fixed scales"
    return _page(drawn, extents, marks, norms, words)


def every_cycle_figure(cycles: CycleSets, means: CurveSets, marks: Mapping[str, Marks], norms: Norms = NO_NORMS) -> str:
    """Draw every cycle of each side as a thin line, and the means above them, in the units of the curves."""
    drawn = {p.name: cycle_lines(p.axes, cycles.get(p.name, {}), means.get(p.name, {})) for p in PANELS}
    extents = {p.name: every_range(cycles.get(p.name, {})) for p in PANELS}
    words = f"{EVERY_CYCLE}; only cycles with a valid plate contact; fixed scales"
    return _page(drawn, extents, marks, norms, words)


def _page(
    drawn: Mapping[str, str],
    extents: Mapping[str, tuple[float, float] | None],
    marks: Mapping[str, Marks],
    norms: Norms,
    words: str,
) -> str:
    known = replace(norms, curves={p.name: norms.curves[p.name] for p in PANELS if p.name in norms.curves})
    panels = [cycle_panel(p, norm_band(p, known) + drawn[p.name], extents[p.name], marks) for p in PANELS]
    absent = [p.title.lower() for p in PANELS if p.name not in known.curves] if known.curves else []
    lines = (
        words,
        *norm_legend(known),
        *((f"no norms of: {'; '.join(absent)}",) if absent else ()),
        *legend_lines(marks),
    )
    bottom = _TOP + len(_SCALES) * _ROW
    content = "".join(panels) + legend(66.0, bottom + 10.0, lines)
    return figure(_WIDTH, bottom + _LEGEND, content, "Kinetics over the gait cycle")
