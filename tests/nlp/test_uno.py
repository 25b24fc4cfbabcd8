import casadi as ca
import numpy as np
import pytest

from gaitlab.nlp.child_process import ChildFailure, ChildProcess
from gaitlab.nlp.outcome import Outcome
from gaitlab.nlp.problem import NLP
from gaitlab.nlp.uno import Uno

INF = np.inf
NONE = np.zeros(0)


def program(w, f, g=(), **changes):
    """Minimise f of w subject to nothing but what `changes` say."""
    n_w, g = w.numel(), ca.vertcat(*g, ca.SX(0, 1))
    free = {"lbw": np.full(n_w, -INF), "ubw": np.full(n_w, INF), "lbg": np.full(g.numel(), -INF)}
    fields = {"w": w, "p": ca.SX(0, 1), "f": ca.SX(f), "g": g, "ubg": np.full(g.numel(), INF)} | free
    return NLP(**(fields | {key: np.asarray(v, float) if key != "p" else v for key, v in changes.items()}))


@pytest.mark.parametrize("isolated", [True, False])
def test_hock_schittkowski_71(isolated):
    w = ca.SX.sym("w", 4)
    f = w[0] * w[3] * (w[0] + w[1] + w[2]) + w[2]
    g = [w[0] * w[1] * w[2] * w[3], ca.sumsqr(w)]
    nlp = program(w, f, g, lbg=[25.0, 40.0], ubg=[INF, 40.0], lbw=np.ones(4), ubw=np.full(4, 5.0))
    solution = Uno(isolated=isolated).solve(nlp, np.array([1.0, 5.0, 5.0, 1.0]), NONE)
    np.testing.assert_allclose(solution.w, [1.0, 4.74299963, 3.82114998, 1.37940829], atol=1e-7)
    assert solution.is_optimal(1e-6)
    assert solution.outcome is Outcome.SOLVED
    assert 3 <= solution.iterations <= 10


def test_one_child_serves_many_parameters():
    w, p = ca.SX.sym("w"), ca.SX.sym("p")
    with Uno().prepare(program(w, (w - p) ** 2, p=p)) as prepared:
        found = [prepared.solve(np.zeros(1), np.array([value])).w[0] for value in (1.0, 2.0, -3.0)]
    np.testing.assert_allclose(found, [1.0, 2.0, -3.0], atol=1e-9)


def test_infeasible_unbounded_and_unfinished_are_told_apart():
    w = ca.SX.sym("w")
    apart = program(w, w, [w, w], lbg=[1.0, -INF], ubg=[INF, 0.0])
    falling = program(w, -(w**3), lbw=np.zeros(1))
    curved = program(w, ca.exp(-w) + w**4)
    assert Uno().solve(apart, np.zeros(1), NONE).outcome is Outcome.INFEASIBLE
    assert Uno().solve(falling, np.ones(1), NONE).outcome is Outcome.UNBOUNDED
    assert Uno(max_iter=1).solve(curved, np.full(1, 3.0), NONE).outcome is Outcome.ITERATION_LIMIT


def test_a_child_that_dies_is_a_result_and_the_next_solve_starts_another():
    w = ca.SX.sym("w")
    with Uno().prepare(program(w, (w - 1.0) ** 2)) as prepared:
        prepared.solve(np.zeros(1), NONE)
        prepared._child._process.kill()
        prepared._child._process.wait()
        assert prepared.solve(np.zeros(1), NONE).w[0] == pytest.approx(1.0)
    broken = Uno(memory=1_000_000).solve(program(w, w**2), np.ones(1), NONE)
    assert broken.outcome is Outcome.CRASHED
    assert "process" in broken.status


def test_a_child_that_talks_nonsense_or_nothing_is_ended(monkeypatch, tmp_path):
    (tmp_path / "silent.py").write_text("import time\ntime.sleep(60)\n")
    (tmp_path / "chatty.py").write_text("print('a line that is no message' * 9)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    silent = ChildProcess("silent", None, memory=0).ask(None, 0.5)
    chatty = ChildProcess("chatty", None, memory=0).ask(None, 20.0)
    assert isinstance(silent, ChildFailure)
    assert silent.timed_out
    assert isinstance(chatty, ChildFailure)
    assert not chatty.timed_out
