import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.mpcc import MPCC
from gaitlab.nlp.mpcc_conditions import MPCCConditions, Stationarity

FREE = {"lbw": np.full(2, -np.inf), "ubw": np.full(2, np.inf)}
NONE = np.zeros(0)


def corner(f):
    """Minimise f(x, y) subject to 0 <= x perp y >= 0."""
    w = ca.SX.sym("w", 2)
    return MPCC(w=w, f=f(w[0], w[1]), G=w[0], H=w[1], **FREE)


@pytest.mark.parametrize(
    ("f", "point", "expected"),
    [
        (lambda x, y: (x - 1) ** 2 + (y - 1) ** 2, [1.0, 0.0], Stationarity.STRONG),
        (lambda x, y: (x - 1) ** 2 + (y - 1) ** 2, [0.0, 0.0], Stationarity.DESCENT),
        (lambda x, y: x + y, [0.0, 0.0], Stationarity.STRONG),
        (lambda x, y: x - y, [0.0, 0.0], Stationarity.DESCENT),
    ],
)
def test_stationarity_at_known_points(f, point, expected):
    assert MPCCConditions(corner(f)).stationarity(np.array(point), NONE, 1e-6).stationarity is expected


def test_bouligand_but_not_strong():
    """scholtes4 of MacMPEC: at the origin no branch descends, yet the relaxed program does."""
    w = ca.SX.sym("w", 3)
    limits = {"lbw": np.full(3, -np.inf), "ubw": np.full(3, np.inf), "lbg": np.zeros(2), "ubg": np.full(2, np.inf)}
    g = ca.vertcat(4 * w[0] - w[2], 4 * w[1] - w[2])
    problem = MPCC(w=w, f=w[0] + w[1] - w[2], g=g, G=w[0], H=w[1], **limits)
    verdict = MPCCConditions(problem).stationarity(np.zeros(3), NONE, 1e-6)
    assert verdict.stationarity is Stationarity.BOULIGAND


def test_the_way_down_names_the_branch():
    """At the origin x - y falls along y: x must stay zero."""
    verdict = MPCCConditions(corner(lambda x, y: x - y)).stationarity(np.zeros(2), NONE, 1e-6)
    assert verdict.first_half.tolist() == [True]
    assert verdict.slope == pytest.approx(-1.0)


def test_violation_and_complementarity():
    conditions = MPCCConditions(corner(lambda x, y: x))
    values = conditions.values(np.array([0.3, 0.2]), NONE)
    assert conditions.complementarity(values) == pytest.approx(0.2)
    below = np.array([-0.4, 0.0])
    assert conditions.violation(below, conditions.values(below, NONE)) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"ubw": np.zeros(3)}, r"ubw must have shape \(2,\)"),
        ({"H": ca.SX(2, 1)}, "G and H must have the same shape"),
        ({"lbw": np.array([0.0, 3.0]), "ubw": np.ones(2)}, r"bounds of w\[1\] cross"),
        ({"f": ca.SX.sym("z")}, "depend on z"),
        ({"f": ca.SX(2, 1)}, "f must be scalar"),
    ],
)
def test_malformed_problems_are_refused(changes, sentence):
    w = ca.SX.sym("w", 2)
    with pytest.raises(ProblemError, match=sentence):
        MPCC(**({"w": w, "f": w[0], "G": w[0], "H": w[1]} | FREE | changes))


def test_starts_are_checked():
    with pytest.raises(ProblemError, match=r"w0\[1\] is inf"):
        corner(lambda x, y: x).check_start(np.array([0.0, np.inf]))
