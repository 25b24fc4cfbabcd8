"""Processes of our own: results in order, errors carried over, lost children named."""

import os
import signal
import sys
import threading
import time
from dataclasses import dataclass

import pytest

from gaitlab.errors import Cancelled, ProblemError, WorkerLost
from gaitlab.nlp.workers import Workers, results_of, usable_processors


@dataclass(frozen=True)
class Square:
    x: float

    def run(self):
        if self.x < 0:
            raise ProblemError("x must not be negative")
        time.sleep(0.02 * (3.0 - self.x))
        sys.stdout.write("noise")
        return self.x**2, os.getpid()


@dataclass(frozen=True)
class Die:
    def run(self):
        os._exit(7)


@pytest.fixture
def workers(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.path.dirname(__file__))
    with Workers(2) as found:
        yield found


def test_results_come_in_the_order_of_the_tasks(workers):
    told = []
    results = workers.map([Square(x) for x in (0.0, 1.0, 2.0)], lambda i, found: told.append((i, found[0])))
    assert [value for value, _ in results] == [0.0, 1.0, 4.0]
    assert sorted(told) == [(0, 0.0), (1, 1.0), (2, 4.0)]
    assert os.getpid() not in {pid for _, pid in results}


def test_errors_of_a_task_are_raised_here(workers):
    with pytest.raises(ProblemError, match="not be negative"):
        workers.map([Square(1.0), Square(-1.0)])


def test_a_child_that_dies_is_named(workers):
    with pytest.raises(WorkerLost, match=r"ended without a result \(code (7|-9)\)"):
        workers.map([Die()])


def test_whoever_is_told_may_cancel(workers):
    def cancel(_index, _found):
        raise Cancelled

    with pytest.raises(Cancelled):
        workers.map([Square(x) for x in (0.0, 1.0, 2.0)], cancel)


def test_children_end_with_the_context():
    with Workers(1) as found:
        (process,) = found._processes
    assert process.poll() is not None


def test_there_is_a_processor():
    assert usable_processors() >= 1


def test_threads_share_the_workers(workers):
    calls = [lambda x=x: workers.map([Square(x), Square(x + 1.0)]) for x in (0.0, 1.0)]
    first, second = workers.side_by_side(calls)
    assert [[value for value, _ in found] for found in (first, second)] == [[0.0, 1.0], [1.0, 4.0]]


def test_what_a_call_raised_counts_more_than_the_workers_that_it_cost_the_others(workers):
    def give_up():
        workers.map([Square(2.0)], lambda _index, _found: cancel())

    def cancel():
        raise Cancelled

    with pytest.raises(Cancelled):
        workers.side_by_side([lambda: workers.map([Square(0.0)] * 50), give_up])


def test_nothing_side_by_side_is_nothing(workers):
    assert workers.side_by_side([]) == []


def test_without_workers_calls_follow_each_other_in_this_thread():
    threads = results_of([threading.get_ident, threading.get_ident], None)
    assert threads == [threading.get_ident()] * 2


@dataclass(frozen=True)
class Sleep:
    def run(self):
        time.sleep(60.0)


def test_an_interruption_ends_all_that_runs_side_by_side(workers):
    began = time.monotonic()
    threading.Timer(0.5, signal.pthread_kill, (threading.get_ident(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        workers.side_by_side([lambda: workers.map([Sleep()]), lambda: workers.map([Sleep()])])
    assert time.monotonic() - began < 30.0
