"""`gaitlab demo`: the main job on the bundled recordings."""

from pathlib import Path
from typing import Annotated

import typer

from ..pipelines.analyse import Sources
from ..pipelines.bundled import DEMO_CHILDREN, demo_folder
from ..pipelines.options import AnalysisOptions
from .analyse import run_analysis
from .server_extra import load


def demo(
    out: Annotated[Path, typer.Option(help="Folder to write into; made if absent.")] = Path("gaitlab-demo"),
    child: Annotated[str, typer.Option(help=f"One of {', '.join(DEMO_CHILDREN)}.")] = DEMO_CHILDREN[0],
    weights: Annotated[bool, typer.Option(help="Compute the walk and its weights.")] = True,
) -> None:
    """Analyse a simulated child whose true weights are known."""
    folder = demo_folder(child)
    sources = Sources(static=folder / "static.c3d", walks=(folder / "walk1.c3d", folder / "walk2.c3d"))
    run_analysis(sources, AnalysisOptions(weights=weights), out)


def demo_clinic(
    results: Annotated[Path, typer.Option(help="Folder that gaitlab demo wrote.")] = Path("gaitlab-demo"),
    data_dir: Annotated[Path, typer.Option(help="Folder of database and files; made if absent.")] = Path(
        "gaitlab-clinic"
    ),
    child: Annotated[str, typer.Option(help="Whose results they are.")] = DEMO_CHILDREN[0],
    port: Annotated[int, typer.Option(help="Port on 127.0.0.1; 0 for any.", min=0, max=65535)] = 0,
) -> None:
    """Run the web application with the demo patients in it: until Ctrl+C, or in the background without a terminal."""
    load("demo_serving").serve_demo(data_dir, child, results, port)
