"""Lifting: a variable v is added to each pair, 0 <= G - v perp H >= 0, and driven to zero (Hatz 2014, ch. 8).

The constraint normals of the pairs become linearly independent (Theorem 8.2.1). `LiftingL1` adds pi sum v with v >= 0
(8.30a), exact from some finite pi on; `LiftingL2` adds pi |v|^2 (8.30b), which needs pi to infinity. Lifting the
inequalities of problems that are not bilevel, (8.49), is asked for by `inequalities`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from ..mpcc import MPCC
from .method import Schedule
from .slack_form import slack_form
from .treatment import Subproblems, Treatment, with_products


@dataclass(frozen=True, kw_only=True)
class LiftingL1(Treatment):
    """Exact l1 penalty with v >= 0."""

    schedule: Schedule = Schedule(first=1.0, factor=10.0, last=1e6)
    inequalities: bool = False
    """Whether one-sided and two-sided rows of g are lifted too."""

    def pose(self, problem: MPCC) -> Subproblems:
        """The lifted program with its penalty."""
        return _pose(_lift(problem, self.inequalities), 0.0, lambda v: ca.sum1(v))


@dataclass(frozen=True, kw_only=True)
class LiftingL2(Treatment):
    """Quadratic penalty, v free."""

    schedule: Schedule = Schedule(first=1e4, factor=100.0, last=1e10)
    inequalities: bool = False
    """Whether one-sided and two-sided rows of g are lifted too."""

    def pose(self, problem: MPCC) -> Subproblems:
        """The lifted program with its penalty."""
        return _pose(_lift(problem, self.inequalities), -np.inf, lambda v: ca.sumsqr(v))


@dataclass(frozen=True, kw_only=True)
class _Lifted:
    problem: MPCC
    """Variables (w, v), bounds of v infinite, no penalty yet."""
    v: ca.SX
    """Lifting variables, shape (n_v, 1)."""


def _lift(problem: MPCC, inequalities: bool) -> _Lifted:
    rows, lower, upper = [problem.g], [problem.lbg], [problem.ubg]
    pairs = ca.SX.sym("v", problem.n_pairs)
    v = [pairs]
    if inequalities:
        # A row with two different bounds becomes two rows, each lifted away from its own bound.
        kept = np.flatnonzero(problem.lbg == problem.ubg)
        low = np.flatnonzero((problem.lbg != problem.ubg) & np.isfinite(problem.lbg))
        high = np.flatnonzero((problem.lbg != problem.ubg) & np.isfinite(problem.ubg))
        v += [ca.SX.sym("v_low", low.size), ca.SX.sym("v_high", high.size)]
        rows = [_pick(problem.g, kept), _pick(problem.g, low) - v[1], _pick(problem.g, high) + v[2]]
        lower = [problem.lbg[kept], problem.lbg[low], np.full(high.size, -np.inf)]
        upper = [problem.ubg[kept], np.full(low.size, np.inf), problem.ubg[high]]
    every = ca.vertcat(*v)
    free = np.full(every.numel(), np.inf)
    lifted = replace(
        problem,
        w=ca.vertcat(problem.w, every),
        g=ca.vertcat(*rows),
        lbg=np.concatenate(lower),
        ubg=np.concatenate(upper),
        G=problem.G - pairs,
        lbw=np.concatenate([problem.lbw, -free]),
        ubw=np.concatenate([problem.ubw, free]),
    )
    return _Lifted(problem=lifted, v=every)


def _pose(lifted: _Lifted, lowest: float, penalty: Callable[[ca.SX], ca.SX]) -> Subproblems:
    n_v, weight = lifted.v.numel(), ca.SX.sym("pi")
    n_w = lifted.problem.w.numel() - n_v
    lbw = np.concatenate([lifted.problem.lbw[:n_w], np.full(n_v, lowest)])
    form = slack_form(replace(lifted.problem, lbw=lbw))
    m = form.problem
    total = ca.dot(m.G, m.H) if m.n_pairs else ca.SX(0, 1)
    posed = with_products(form, m.f + weight * penalty(lifted.v), total, ca.vertcat(m.p, weight))
    w = lifted.problem.w[:n_w]
    return Subproblems(
        nlp=posed.nlp,
        start=ca.Function("start", [w, m.p], [ca.substitute(form.start, lifted.v, ca.SX.zeros(n_v, 1))]),
        remainder=ca.Function("remainder", [m.w], [ca.norm_inf(lifted.v) if n_v else ca.SX(0)]),
    )


def _pick(g: ca.SX, rows: np.ndarray) -> ca.SX:
    return ca.vertcat(*(g[int(i)] for i in rows), ca.SX(0, 1))
