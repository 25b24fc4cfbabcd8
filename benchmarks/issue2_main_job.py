"""Issue 2, lines 3 to 5: the whole job through the command line, on children and on bad input."""

import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from registry import CHILDREN, SHARED_DATA, Row, measurement


@measurement(issue=2, line=3)
def weights_of_children() -> Iterator[Row]:
    for child in CHILDREN:
        first, second = _analyse(child), _analyse(child)
        yield from _weights(child, first)
        difference = max(
            abs(a["weight"] - b["weight"])
            for a, b in zip(first["weights"]["criteria"], second["weights"]["criteria"], strict=True)
        )
        yield Row(quantity="same command twice", value=difference, limit="<= 1e-6", unit="", subject=child)
        yield Row(quantity="C3D to weights, warm", value=second["seconds"], limit="", unit="s", subject=child)
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    yield Row(quantity="largest resident memory", value=memory, limit="<= 2", unit="GB", subject="all children")


def _weights(child: str, result: dict) -> Iterator[Row]:
    weights = result["weights"]
    solver, fit, comparison = weights["solver"], weights["fit"], weights["comparison"]
    single = [value for value in comparison["single_criterion_rms_rad"].values() if value is not None]
    limits = (
        ("tracking", solver["tracking_rms_rad"], "<= 0.03", "rad"),
        ("KKT residual", solver["kkt_residual"], "<= 1e-6", ""),
        ("fit", fit["rms_rad"], "<= 0.06", "rad"),
        ("fit minus that of equal weights", fit["rms_rad"] - comparison["equal_weights_rms_rad"], "<= 0", "rad"),
        ("fit minus best single criterion", fit["rms_rad"] - min(single), "<= 0", "rad"),
        ("tracking time", solver["tracking_seconds"], "<= 10", "s"),
        ("weights time", solver["seconds"], "<= 60", "s"),
    )
    for quantity, value, limit, unit in limits:
        yield Row(quantity=quantity, value=value, limit=limit, unit=unit, subject=child)


def _analyse(child: str) -> dict:
    """The result of the command on one child, with the seconds it took."""
    folder = Path(SHARED_DATA) / "children" / child
    static, walk = (next(folder.glob(f"{kind}_*.c3d")) for kind in ("static", "straight"))
    with tempfile.TemporaryDirectory() as out:
        start = time.perf_counter()
        _gaitlab("analyse", "--static", static, walk, "--out", out)
        seconds = time.perf_counter() - start
        return json.loads((Path(out) / "result.json").read_text()) | {"seconds": seconds}


def _gaitlab(*arguments: object) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-c", "from gaitlab.cli import main; main()", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@measurement(issue=2, line=5)
def bad_input() -> Iterator[Row]:
    tests = ["tests/cli/test_bad_input.py", "-q", "--junitxml"]
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        subprocess.run([sys.executable, "-m", "pytest", *tests, str(report)], capture_output=True, check=False)
        head = report.read_text().split("<testcase", 1)[0]
    counts = {word: int(head.split(f'{word}="', 1)[1].split('"', 1)[0]) for word in ("tests", "failures", "errors")}
    yield Row(quantity="kinds of bad input tried", value=counts["tests"], limit=">= 11", unit="", subject="command")
    broken = counts["failures"] + counts["errors"]
    yield Row(quantity="without a clear message", value=broken, limit="<= 0", unit="", subject="command")
