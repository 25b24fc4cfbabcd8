"""What is printed at the end of an analysis."""

from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from ..clinical.document import Document, SpatiotemporalEntry, WeightsEntry

SHOWN = {
    "speed_m_per_s": "speed [m/s]",
    "cadence_steps_per_min": "cadence [steps/min]",
    "step_length_m": "step length [m]",
    "step_width_m": "step width [m]",
    "foot_off_percent": "foot off [%]",
}


def print_summary(document: Document, out: Path) -> None:
    """Tables of distances, times and weights, then the warnings and the path of the report."""
    console = Console()
    console.print(_spatiotemporal(document.spatiotemporal))
    if document.weights is not None:
        console.print(_weights(document.weights))
    for warning in document.warnings:
        console.print(f"warning: {warning}", style="yellow", markup=False, highlight=False, soft_wrap=True)
    console.print(f"report: {out / 'report.html'}", markup=False, highlight=False, soft_wrap=True)


def _spatiotemporal(entry: SpatiotemporalEntry) -> Table:
    table = Table("", "left", "right", title="Distances and times")
    for field, title in SHOWN.items():
        means = [None if side is None else getattr(side.mean, field) for side in (entry.left, entry.right)]
        table.add_row(escape(title), *("-" if value is None else f"{value:.2f}" for value in means))
    return table


def _weights(entry: WeightsEntry) -> Table:
    table = Table("criterion", "weight", "sd", "identifiable", title="What this walk trades off")
    for criterion in entry.criteria:
        deviation = "-" if criterion.sd is None else f"{criterion.sd:.3f}"
        table.add_row(criterion.name, f"{criterion.weight:.3f}", deviation, "yes" if criterion.identifiable else "no")
    table.caption = f"fit {entry.fit.rms_rad:.4f} rad rms, {entry.solver.status} in {entry.solver.seconds:.1f} s"
    return table
