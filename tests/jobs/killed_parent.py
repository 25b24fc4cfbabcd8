"""Starts a computation that hangs, prints its process number, and is killed."""

import asyncio
import os
import signal
import sys
from pathlib import Path

import psutil

from gaitlab.jobs.request import Work
from gaitlab.jobs.supervision import Limits, Verdict, Watch, run_process


def tell_and_die(step):
    sys.stdout.write(f"{psutil.Process().children()[0].pid}\n")
    sys.stdout.flush()
    os.kill(os.getpid(), signal.SIGKILL)


async def go_on():
    return Verdict.GO_ON


folder = Path(sys.argv[1])
(folder / "out").mkdir()
work = Work(kind="analyse", settings={"do": "hang"}, inputs=(), folder=folder)
limits = Limits(seconds=60.0, memory=8_000_000_000)
asyncio.run(run_process(work, limits, Watch(progress=tell_and_die, ask=go_on), sys.argv[2]))
