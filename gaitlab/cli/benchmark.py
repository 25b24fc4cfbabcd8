"""`gaitlab benchmark`: the commands that measure the library on published problems."""

import typer

from .benchmark_gait import gait
from .benchmark_mpcc import mpcc
from .benchmark_ocp import ocp

benchmark = typer.Typer(name="benchmark", help="Solve published problems and print the results beside those published.")
benchmark.command()(ocp)
benchmark.command()(mpcc)
benchmark.command()(gait)
