"""`gaitlab predict`: the new gait of a changed body or task."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from ..clinical.prediction_document import PredictionEntry
from ..errors import NotConverged
from ..pipelines.output import make_folder, write_trial
from ..pipelines.predict import predict_walk
from ..pipelines.prediction_source import read_source
from ..report.files import write_preview
from ..walking.quantities import QUANTITIES
from .progress import progress_bars

SHOWN = {
    "speed_m_per_s": "speed [m/s]",
    "cadence_steps_per_min": "cadence [steps/min]",
    "step_length_m": "step length [m]",
}
JOINTS = ("hip_extensor", "hip_flexor", "hip_abductor", "knee_extensor", "ankle_plantarflexor")


def _list_quantities(wanted: bool) -> None:
    if not wanted:
        return
    table = Table("quantity", "unit", "from", "to", "percent of", "meaning")
    for q in QUANTITIES.values():
        table.add_row(q.name, q.unit, f"{q.lowest:g}", f"{q.highest:g}", q.relative_to or "-", q.meaning)
    Console(width=150).print(table)
    raise typer.Exit


def predict(
    directory: Annotated[Path, typer.Argument(help="Folder written by gaitlab analyse, with weights.")],
    out: Annotated[Path, typer.Option(help="Folder to write into; made if absent.")],
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="A change as name=value in the quantity's unit, or name=+10% of what it is: speed, step_length, "
            "cadence; mass, SIDE_thigh_length, SIDE_shank_mass ...; SIDE_tibial_torsion; SIDE_knee_flexion_max; "
            "SIDE_ankle_plantarflexor_limit; SIDE_ankle_orthosis. Repeat it for several. --quantities lists all.",
        ),
    ] = None,
    trial: Annotated[str, typer.Option(help="Which walk of the folder; default the first.")] = "",
    quantities: Annotated[
        bool,
        typer.Option("--quantities", help="List what can be set and stop.", callback=_list_quantities, is_eager=True),
    ] = False,
) -> None:
    """Predict the gait of a changed body or task from an identified one, in small certified steps."""
    del quantities  # Its callback has listed them.
    source = read_source(directory, trial)
    make_folder(out)
    with progress_bars() as progress:
        walk = predict_walk(source, changes or [], progress)
        write_trial(walk.trial, walk.document, out)
        write_preview(out)
    entry = walk.document.prediction
    if entry is not None:
        _print(entry, out)
    if walk.prediction.reason:
        raise NotConverged(f"{walk.prediction.reason}; the gait reached so far is in {out}")


def _print(entry: PredictionEntry, out: Path) -> None:
    console = Console()
    path = Table("share", "speed [m/s]", "step length [m]", "cadence", "residual", title="Continuation path")
    for step in entry.path:
        numbers = (step.share, step.speed_m_per_s, step.step_length_m, step.cadence_steps_per_min)
        mark = " (jump)" if step.jump else ""
        path.add_row(*(f"{number:.3f}" for number in numbers), f"{step.kkt_residual:.0e}{mark}")
    console.print(path)
    result = Table("", "identified", "predicted", "change", title="What it changes")
    peaks = {f"{s}_{j}_peak_nm_per_kg": f"{s} {j} peak \\[N*m/kg]" for j in JOINTS for s in ("left", "right")}
    for name, title in ({key: title.replace("[", "\\[") for key, title in SHOWN.items()} | peaks).items():
        old, new = entry.identified[name], entry.predicted[name]
        change = f"{100 * (new / old - 1):+.1f} %" if abs(old) > 1e-9 else "-"
        result.add_row(title.replace("_", " "), f"{old:.3f}", f"{new:.3f}", change)
    console.print(result)
    console.print(f"report: {out / 'report.html'}", markup=False, highlight=False, soft_wrap=True)
