"""Small inverse problems whose answers are known by hand."""

import casadi as ca
import numpy as np

from gaitlab.bilevel.inverse_problem import InverseProblem
from gaitlab.nlp.problem import NLP

INF = np.inf


def program(w, p, f, g=(), **changes):
    """Minimise f over w for parameters p, subject to nothing but what `changes` say."""
    n_w, g = w.numel(), ca.vertcat(*g, ca.SX(0, 1))
    fields = {"lbw": np.full(n_w, -INF), "ubw": np.full(n_w, INF)}
    fields |= {"lbg": np.full(g.numel(), -INF), "ubg": np.full(g.numel(), INF)} | changes
    return NLP(w=w, p=p, f=f, g=g, **{key: np.asarray(value, dtype=float) for key, value in fields.items()})


def inverse(nlp, residual, **changes):
    """All parameters free between -100 and 100."""
    n_p = nlp.p.numel()
    fields = {"free": np.ones(n_p, dtype=bool), "lbp": np.full(n_p, -100.0), "ubp": np.full(n_p, 100.0)}
    return InverseProblem(nlp=nlp, residual=residual, **(fields | {"p_nominal": np.zeros(n_p)} | changes))


def clipped():
    """w* = min(p, 1) twice and 2 p: the first two measurements lie beyond the bound, so p = 1.3 by the third alone.

    Residuals (w_0 - 1.2, w_1 - 2.6); w_0 <= 1 is active at the solution.
    """
    w, p = ca.SX.sym("w", 2), ca.SX.sym("p")
    f = (w[0] - p) ** 2 + (w[1] - 2 * p) ** 2
    return inverse(program(w, p, f, ubw=[1.0, INF]), ca.vertcat(w[0] - 1.2, w[1] - 2.6), p_nominal=np.array([0.2]))


def weighted_mean():
    """w* = the mean of 0, 1, 4 and of 0, 2, 2 weighted by theta on the simplex; measured for theta = (.5, .3, .2)."""
    w, theta = ca.SX.sym("w", 2), ca.SX.sym("theta", 3)
    targets = [ca.DM([0.0, 1.0, 4.0]), ca.DM([0.0, 2.0, 2.0])]
    f = sum(ca.dot(theta, (w[k] - target) ** 2) for k, target in enumerate(targets))
    limits = {"lbp": np.zeros(3), "ubp": np.ones(3), "p_nominal": np.full(3, 1 / 3), "simplex": (0, 1, 2)}
    return inverse(program(w, theta, f), (w - ca.DM([1.1, 1.0])) / 0.1, **limits)


WEIGHTS = np.array([0.5, 0.3, 0.2])


def unidentifiable():
    """w* depends on the product p_0 p_1 only."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p", 2)
    nlp = program(w, p, (w - p[0] * p[1]) ** 2)
    return inverse(nlp, w - 6.0, lbp=np.full(2, 0.1), p_nominal=np.array([1.0, 2.0]), names=("stiffness", "length"))


def infeasible():
    """w <= -1 and w >= 1."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p")
    return inverse(program(w, p, (w - p) ** 2, [w, w], lbg=[1.0, -INF], ubg=[INF, -1.0]), w - 1.0)


def unbounded():
    """The lower level runs to minus infinity."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p")
    return inverse(program(w, p, p * w), w - 1.0, p_nominal=np.array([1.0]))


def not_a_number():
    """The square root of a negative number at the start."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p")
    return inverse(program(w, p, (w - p) ** 2, [ca.sqrt(w - 5.0)], lbg=[0.0]), w - 1.0, p_nominal=np.array([1.0]))


def rank_deficient():
    """Nothing in the lower level determines w_1."""
    w, p = ca.SX.sym("w", 2), ca.SX.sym("p")
    return inverse(program(w, p, (w[0] - p) ** 2), w[0] + w[1] - 1.0, p_nominal=np.array([0.5]))


def out_of_reach():
    """The upper level wants w >= 2, the bound on p allows 1."""
    w, p = ca.SX.sym("w"), ca.SX.sym("p")
    nlp = program(w, p, (w - p) ** 2)
    limits = {"upper": ca.SX(w), "lbu": np.array([2.0]), "ubu": np.array([INF]), "ubp": np.ones(1)}
    return inverse(nlp, w - 0.5, p_nominal=np.array([0.2]), **limits)
