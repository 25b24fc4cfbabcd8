"""The process of one computation: `python -m gaitlab.jobs.computing_process DESCRIPTOR`, the work as JSON on stdin.

Progress goes to the descriptor, one JSON object a line; how it ended goes to `outcome.json` in the job's folder, which
appears in one step. It dies with the worker that started it.
"""

import contextlib
import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..clinical.environment import environment
from ..errors import GaitlabError
from ..pipelines.progress import Step
from .request import Work

OUTCOME = "outcome.json"
PARENT_DEATH_SIGNAL = 1
"""PR_SET_PDEATHSIG of prctl(2)."""
AUTOGROUP = Path("/proc/self/autogroup")
PACKAGES = ("numpy", "scipy", "casadi", "pin", "ezc3d")
INTERVAL = 0.2
"""Shortest time between two reports of the same stage [s]."""


class Reporter:
    """Writes progress to a pipe."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._last, self._stage = 0.0, ("", "")

    def __call__(self, step: Step) -> None:
        """Report, unless the same stage reported a moment ago."""
        now = time.monotonic()
        if (step.stage, step.trial) == self._stage and now - self._last < INTERVAL:
            return
        self._last, self._stage = now, (step.stage, step.trial)
        try:
            os.write(self._descriptor, json.dumps(asdict(step)).encode() + b"\n")
        except BrokenPipeError:
            # The worker is gone; where the system does not end its children, they end themselves.
            os._exit(1)


def main() -> None:
    """Read the work, limit this process, compute, write the outcome."""
    described: dict[str, Any] = json.load(sys.stdin)
    _die_with(described["parent"])
    _limit(described["memory"], described["niceness"])
    work = Work(
        kind=described["kind"],
        settings=described["settings"],
        inputs=tuple(described["inputs"]),
        folder=Path(described["folder"]),
    )
    outcome = _compute(work, Reporter(int(sys.argv[1])))
    part = work.folder / f"{OUTCOME}.part"
    part.write_text(json.dumps(outcome | {"environment": environment(PACKAGES)}), encoding="utf-8")
    part.replace(work.folder / OUTCOME)


def _compute(work: Work, reporter: Reporter) -> dict[str, Any]:
    # Loaded only now: the limits hold for native libraries, too.
    registry = importlib.import_module("gaitlab.jobs.computations.registry")
    try:
        return asdict(registry.compute(work, reporter))
    except GaitlabError as error:
        return {"error": _without_folder(str(error), work.folder), "error_kind": type(error).__name__}
    except MemoryError:
        return {"error": "the job needs more memory than it may use", "error_kind": "OutOfMemory"}


def _without_folder(sentence: str, folder: Path) -> str:
    """The sentence of the command line, without the folders of this machine."""
    return sentence.replace(f"{folder / 'inputs'}{os.sep}", "").replace(f"{folder}{os.sep}", "")


def _die_with(parent: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _limit(memory: int, niceness: int) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.nice(niceness)
    # Linux may weigh whole sessions against each other (sched(7), autogroup), and this process has one of its own.
    with contextlib.suppress(OSError):
        AUTOGROUP.write_text(str(niceness))


if __name__ == "__main__":
    main()
