"""The plain nonlinear program: G >= 0, H >= 0, G'H <= 0 (Hatz 2014, (8.16); Fletcher and Leyffer 2004)."""

from dataclasses import dataclass

import casadi as ca

from ..mpcc import MPCC
from .method import Schedule
from .slack_form import slack_form
from .treatment import Subproblems, Treatment, with_products


@dataclass(frozen=True, kw_only=True)
class Unlifted(Treatment):
    """One subproblem, without a parameter that matters."""

    schedule: Schedule = Schedule(first=0.0, factor=2.0, last=0.0)

    def pose(self, problem: MPCC) -> Subproblems:
        """The complementarity of all pairs as one row."""
        form = slack_form(problem)
        m = form.problem
        total = ca.dot(m.G, m.H) if m.n_pairs else ca.SX(0, 1)
        return with_products(form, m.f, total, ca.vertcat(m.p, ca.SX.sym("unused")))
