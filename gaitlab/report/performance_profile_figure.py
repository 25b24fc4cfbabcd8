"""Figure of performance profiles, like Hatz (2014), figures 13.1 and 13.2."""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from ..benchmarks.performance_profile import Profile

# matplotlib writes random identifiers and the date unless told otherwise; the same input must give the same bytes.
_SVG: dict[Any, str] = {"svg.hashsalt": "gaitlab", "svg.fonttype": "none"}
LINES = ("-", "--", "-.", ":")


def profile_figure(panels: Mapping[str, Sequence[Profile]]) -> str:
    """SVG with one panel per measure: part of the problems solved within a factor of the best method."""
    figure = Figure(figsize=(5.5 * len(panels), 4.5), layout="constrained")
    for i, (measure, profiles) in enumerate(panels.items()):
        axes = figure.add_subplot(1, len(panels), i + 1)
        farthest = max((float(profile.ratios.max(initial=1.0)) for profile in profiles), default=1.0)
        for k, profile in enumerate(profiles):
            tau = np.concatenate([[1.0], profile.ratios, [1.1 * farthest]])
            rho = np.concatenate([[0.0], profile.parts, profile.parts[-1:] if profile.parts.size else [0.0]])
            style = LINES[(k // 10) % len(LINES)] if len(profiles) > 10 else LINES[k % 2]
            axes.step(tau, rho, where="post", label=profile.method, linestyle=style)
        axes.set_xscale("log")
        axes.set_xlim(1.0, 1.1 * farthest)
        axes.set_ylim(0.0, 1.02)
        axes.set_xlabel(f"factor of the best method's {measure}")
        axes.set_ylabel("part of the problems")
        axes.grid(alpha=0.3)
    if figure.axes:
        figure.axes[-1].legend(fontsize="x-small", loc="lower right")
    text = io.StringIO()
    with rc_context(_SVG):
        FigureCanvasSVG(figure).print_svg(text, metadata={"Date": None})
    return text.getvalue()
