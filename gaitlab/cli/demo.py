"""`gaitlab demo`: the main job on the bundled recordings."""

from pathlib import Path
from typing import Annotated

import typer

from ..pipelines.analyse import Sources
from ..pipelines.bundled import DEMO_CHILDREN, demo_folder
from ..pipelines.options import AnalysisOptions
from .analyse import run_analysis


def demo(
    out: Annotated[Path, typer.Option(help="Folder to write into; made if absent.")] = Path("gaitlab-demo"),
    child: Annotated[str, typer.Option(help=f"One of {', '.join(DEMO_CHILDREN)}.")] = DEMO_CHILDREN[0],
    weights: Annotated[bool, typer.Option(help="Compute the walk and its weights.")] = True,
) -> None:
    """Analyse a simulated child whose true weights are known."""
    folder = demo_folder(child)
    sources = Sources(static=folder / "static.c3d", walks=(folder / "walk1.c3d", folder / "walk2.c3d"))
    run_analysis(sources, AnalysisOptions(weights=weights), out)
