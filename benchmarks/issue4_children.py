"""Issue 4, line 1: the whole command on real children, C3D to weights, kinetics and report: time and memory."""

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import psutil
from registry import CHILDREN, SHARED_DATA, Row, measurement

EVERY = 0.2
"""Time between two looks at the memory [s]."""


@measurement(issue=4, line=1)
def real_children() -> Iterator[Row]:
    for child in CHILDREN:
        seconds, spent, memory = _analyse(child)
        yield Row(quantity="C3D to weights, whole command", value=seconds, limit="<= 30", unit="s", subject=child)
        yield Row(quantity="processor time of all processes", value=spent, limit="", unit="s", subject=child)
        yield Row(quantity="memory of all processes", value=memory, limit="<= 1.5", unit="GB", subject=child)


def _analyse(child: str) -> tuple[float, float, float]:
    """Seconds, processor seconds, and the most memory [GB] that the command and its children had at once."""
    folder = Path(SHARED_DATA) / "children" / child
    static, walk = (next(folder.glob(f"{kind}_*.c3d")) for kind in ("static", "straight"))
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-c", "from gaitlab.cli import main; main()", "analyse", "--static", str(static)]
        before, start, most = psutil.Process().cpu_times(), time.perf_counter(), 0.0
        with subprocess.Popen([*command, str(walk), "--out", out], stdout=subprocess.DEVNULL) as process:
            while process.poll() is None:
                most = max(most, _memory(process.pid))
                time.sleep(EVERY)
        seconds, after = time.perf_counter() - start, psutil.Process().cpu_times()
    if process.returncode != 0:
        raise RuntimeError(f"the command on {child} ended with exit code {process.returncode}")
    spent = after.children_user + after.children_system - before.children_user - before.children_system
    return seconds, spent, most / 1e9


def _memory(pid: int) -> float:
    """Memory of a process and its children [bytes]; what several share counts once."""
    total = 0.0
    with suppress(psutil.NoSuchProcess):
        for process in (parent := psutil.Process(pid), *parent.children(recursive=True)):
            with suppress(psutil.NoSuchProcess, psutil.AccessDenied):
                total += process.memory_full_info().pss
    return total
