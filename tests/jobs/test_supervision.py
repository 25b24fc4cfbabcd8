"""One process per computation: what it tells, how it ends, what is left of it."""

import asyncio
import os
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from gaitlab.jobs.computing_process import AUTOGROUP
from gaitlab.jobs.request import Work
from gaitlab.jobs.supervision import Limits, Verdict, Watch, run_process

LIMITS = Limits(seconds=120.0, memory=8_000_000_000)
CANCEL_SECONDS = 2.0


class Follower:
    """Keeps the progress, and asks for an end once a stage is reached."""

    def __init__(self, until="", verdict=Verdict.CANCEL):
        self.steps, self.until, self.verdict = [], until, verdict
        self.processes, self.asked_at = [], None
        self.others = psutil.Process().children(recursive=True)

    async def ask(self):
        if self.until not in [step["stage"] for step in self.steps]:
            return Verdict.GO_ON
        self.processes = [each for each in psutil.Process().children(recursive=True) if each not in self.others]
        self.asked_at = time.monotonic()
        return self.verdict


def run(folder, toy, follower, limits=LIMITS, **settings):
    (folder / "inputs").mkdir()
    (folder / "out").mkdir()
    work = Work(kind="analyse", settings=settings, inputs=(), folder=folder)
    return asyncio.run(run_process(work, limits, Watch(progress=follower.steps.append, ask=follower.ask), toy))


def test_progress_and_outcome_arrive(tmp_path, toy):
    follower = Follower()
    ended = run(tmp_path, toy, follower)
    assert (ended.verdict, ended.code) == (Verdict.GO_ON, 0)
    assert [step["stage"] for step in follower.steps] == ["computing"]
    assert ended.outcome["summary"] == {"answer": 42}
    assert "casadi" in ended.outcome["environment"]


def test_a_native_crash_is_data(tmp_path, toy):
    ended = run(tmp_path, toy, Follower(), do="crash")
    assert ended.signal == "SIGSEGV"
    assert ended.outcome is None
    assert "invalid pointer" in ended.stderr


def test_a_refusal_is_the_sentence_of_the_command_line_without_folders(tmp_path, toy):
    ended = run(tmp_path, toy, Follower(), do="refuse")
    assert (ended.outcome["error"], ended.outcome["error_kind"]) == ("walk.c3d: no markers", "InvalidRecording")


def test_the_memory_limit_holds(tmp_path, toy):
    ended = run(tmp_path, toy, Follower(), do="grow", bytes=2 * LIMITS.memory)
    assert ended.outcome["error_kind"] == "OutOfMemory"


def test_long_computations_step_back_also_where_sessions_are_weighed_against_each_other(tmp_path, toy):
    limits = Limits(seconds=120.0, memory=LIMITS.memory, niceness=7)
    told = run(tmp_path, toy, Follower(), limits, do="step_back").outcome["summary"]
    assert told["nice"] == os.nice(0) + 7
    assert told["session"].split()[-2:] == ["nice", "7"] if AUTOGROUP.exists() else told["session"] == ""


def test_a_computation_without_end_is_ended(tmp_path, toy):
    ended = run(tmp_path, toy, Follower(), Limits(seconds=1.0, memory=LIMITS.memory), do="hang")
    assert (ended.verdict, ended.signal) == (Verdict.TIME_OUT, "SIGKILL")


def test_cancelling_ends_the_process_and_its_children_within_two_seconds(tmp_path, toy):
    follower = Follower(until="hanging")
    ended = run(tmp_path, toy, follower, do="hang")
    assert ended.verdict is Verdict.CANCEL
    assert time.monotonic() - follower.asked_at < CANCEL_SECONDS
    assert len(follower.processes) == 2
    assert psutil.wait_procs(follower.processes, timeout=CANCEL_SECONDS)[1] == []


@pytest.mark.skipif(sys.platform != "linux", reason="the system ends children of dead parents on Linux only")
def test_the_process_dies_with_its_parent(tmp_path, toy):
    script = Path(__file__).with_name("killed_parent.py")
    parent = subprocess.run([sys.executable, str(script), str(tmp_path), toy], capture_output=True, text=True)
    assert parent.returncode == -9
    child = int(parent.stdout)
    deadline = time.monotonic() + 5.0
    while psutil.pid_exists(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not psutil.pid_exists(child) or psutil.Process(child).status() == psutil.STATUS_ZOMBIE
    assert os.getpid() != child
