"""`gaitlab benchmark gait`: the inverse problems of the gait models of Hatz (2014), chapter 15, at full size."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from ..errors import NotConverged
from ..nlp.workers import worker_pool
from ..pipelines.gait_benchmark import COLUMNS, rows, solve_case
from ..pipelines.gait_cases import CASES, available_cases, load_case, thesis_gait
from ..report.gait_benchmark_figure import coordinates, postures, torques, velocities
from ..walking.gait_courses import courses
from .benchmark_ocp import as_table, write_files


def gait(
    model: Annotated[list[str] | None, typer.Option(help=f"Only this model, repeatable: {', '.join(CASES)}.")] = None,
    noise: Annotated[float, typer.Option(min=0.0, help="Noise of the measurements: 1 is 1 degree and 10 mm.")] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the noise.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables (CSV) and figures (SVG); made if absent.")] = Path(
        "gaitlab-benchmark"
    ),
) -> None:
    """Estimate the weights of the thesis's two gaits from simulated measurements, thesis beside ours."""
    names, console, failed = [thesis_gait(name).name for name in model or available_cases()], Console(), list[str]()
    with worker_pool() as workers:
        for name in names:
            case = load_case(name)
            console.print(f"{case.thesis.title} ...", style="dim")
            run = solve_case(case, noise, seed, workers=workers)
            table, course = rows(run), courses(run.optimum)
            console.print(as_table(case.thesis.title, COLUMNS, table))
            title = case.thesis.title
            files = {
                f"{name}.csv": "\n".join(",".join(f'"{cell}"' for cell in row) for row in [COLUMNS, *table]) + "\n",
                f"{name}-coordinates.svg": coordinates(course, title),
                f"{name}-velocities.svg": velocities(course, title),
                f"{name}-torques.svg": torques(course, title),
                f"{name}-side.svg": postures(course, title, lateral=True),
                f"{name}-front.svg": postures(course, title, lateral=False),
            }
            write_files(files, out)
            console.print(f"written to {out}: {', '.join(files)}")
            if not run.certified:
                failed.append(name)
    if failed:
        raise NotConverged(f"weights without a certificate: {', '.join(failed)}")
