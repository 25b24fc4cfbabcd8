"""A computing process whose computation is what its settings say: it stands in for hours of work and for crashes."""

import importlib
import os
import signal
import subprocess
import sys
import time
import types

from gaitlab.errors import InvalidRecording
from gaitlab.jobs import computing_process
from gaitlab.pipelines.progress import Step

outcome = importlib.import_module("gaitlab.jobs.computations.outcome")


def succeed(work, progress):
    progress(Step(stage="computing", done=0.5))
    (work.out / "trial").mkdir()
    text = "".join(path.read_text() for path in work.paths("walk"))
    (work.out / "trial" / "result.json").write_text(text or "{}")
    return outcome.Outcome(summary={"answer": 42})


def hang(work, progress):
    # Like our own helpers, it ends with its parent at the latest, because its stdin does.
    helper = subprocess.Popen([sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=subprocess.PIPE)
    progress(Step(stage="hanging", iteration=helper.pid))
    time.sleep(work.settings.get("seconds", 600))
    return succeed(work, progress)


def crash(work, progress):
    sys.stderr.write("free(): invalid pointer\n")
    sys.stderr.flush()
    os.kill(os.getpid(), signal.SIGSEGV)


def refuse(work, progress):
    raise InvalidRecording(f"{work.folder / 'inputs' / 'walk.c3d'}: no markers")


def grow(work, progress):
    return bytearray(work.settings["bytes"])


def step_back(work, progress):
    group = computing_process.AUTOGROUP
    session = group.read_text() if group.exists() else ""
    return outcome.Outcome(summary={"nice": os.nice(0), "session": session})


def describe(work, progress):
    return outcome.Outcome(summary={"rows": [["frames", "3"]], "personal_entries": ["a name"]})


def model(work, progress):
    (work.out / "model.urdf").write_text("<robot/>")
    return outcome.Outcome()


def compute(work, progress):
    return globals()[work.settings.get("do", "succeed")](work, progress)


if __name__ == "__main__":
    registry = types.ModuleType("registry")
    registry.compute = compute
    sys.modules["gaitlab.jobs.computations.registry"] = registry
    computing_process.main()
