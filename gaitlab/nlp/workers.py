"""Processes of our own for solves that do not depend on each other.

They are plain children that speak through pipes, so that a library user's script needs no guard around its main part,
nothing is forked in the middle of threads, and a child ends when its parent does.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import AbstractContextManager, nullcontext, suppress
from queue import SimpleQueue
from threading import Lock
from types import TracebackType
from typing import Protocol, Self, TypeVar, cast

from ..errors import WorkerLost

Result = TypeVar("Result", covariant=True)

CHILD = "gaitlab.nlp.worker_child"


class Task(Protocol[Result]):
    """Something to compute elsewhere: it must survive pickling."""

    def run(self) -> Result:
        """Compute the result."""
        ...


def usable_processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def worker_pool(count: int = 0) -> "AbstractContextManager[Workers | None]":
    """A context of so many processes, as many as there are processors by default; None where one would be all."""
    count = count or usable_processors()
    return Workers(count) if count > 1 else nullcontext()


def results_of(calls: Sequence[Callable[[], Result]], workers: "Workers | None") -> list[Result]:
    """Results of calls that do not depend on each other: side by side where there are workers, else in turn."""
    return [call() for call in calls] if workers is None else workers.side_by_side(calls)


class Workers:
    """A fixed number of processes, used as a context; they start with it and end with it. Threads may share them."""

    def __init__(self, count: int) -> None:
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
        command = [sys.executable, "-P", "-m", CHILD]
        self._processes = [
            subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
            for _ in range(count)
        ]
        self._closing = Lock()
        self._idle: SimpleQueue[subprocess.Popen[bytes]] = SimpleQueue()
        for process in self._processes:
            self._idle.put(process)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the processes, whatever they are doing; threads that wait for them get no result."""
        for process in self._processes:
            process.kill()
        with self._closing:
            for process in self._processes:
                process.wait()
                for pipe in (process.stdin, process.stdout):
                    # What was not sent any more cannot be flushed.
                    with suppress(OSError, ValueError):
                        if pipe is not None:
                            pipe.close()

    def side_by_side(self, calls: Sequence[Callable[[], Result]]) -> list[Result]:
        """Results of calls that mostly wait for these workers, each in a thread of its own.

        Raises what a call raised; where one gives up, the others lose their workers, which is told only if nothing else
        is.
        """
        with ThreadPoolExecutor(max(len(calls), 1)) as pool:
            futures = [pool.submit(call) for call in calls]
            try:
                raised = [error for error in (future.exception() for future in futures) if error is not None]
            except BaseException:
                # Ctrl+C: the threads end when their processes do.
                self.close()
                raise
        for error in sorted(raised, key=lambda error: isinstance(error, WorkerLost)):
            raise error
        return [future.result() for future in futures]

    def map(self, tasks: Sequence[Task[Result]], done: Callable[[int, Result], None] | None = None) -> list[Result]:
        """Results of the tasks in their order. `done(index, result)` is called as they come and may raise.

        Raises:
            WorkerLost: A process ended without a result.
            GaitlabError: What a task raised.
        """
        results: dict[int, Result] = {}
        pool = ThreadPoolExecutor(len(self._processes))
        try:
            futures = {pool.submit(self._send, task): i for i, task in enumerate(tasks)}
            for future in as_completed(futures):
                results[futures[future]] = future.result()
                if done is not None:
                    done(futures[future], future.result())
        except BaseException:
            # Threads wait for their processes: without those they end at once.
            self.close()
            raise
        finally:
            pool.shutdown(cancel_futures=True)
        return [results[i] for i in range(len(tasks))]

    def _send(self, task: Task[Result]) -> Result:
        process = self._idle.get()
        to_child, from_child = process.stdin, process.stdout
        if to_child is None or from_child is None:
            raise WorkerLost("a computing process has no pipes")
        try:
            pickle.dump(task, to_child)
            to_child.flush()
            outcome: object = pickle.load(from_child)
        except (OSError, EOFError, ValueError, pickle.UnpicklingError) as error:
            process.kill()
            raise WorkerLost(
                f"a computing process ended without a result (code {process.wait()}); "
                "the machine may be out of memory: close other programs or use one process"
            ) from error
        finally:
            # A lost process, too: whoever waits for one must learn that it is lost.
            self._idle.put(process)
        if isinstance(outcome, Exception):
            raise outcome
        return cast("Result", outcome)
