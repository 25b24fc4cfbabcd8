"""Scholtes's relaxation: G_i H_i <= sigma, sigma to zero (SIAM J. Optim. 11, 2001; Hoheisel, Kanzow, Schwartz 2013)."""

from dataclasses import dataclass

import casadi as ca

from ..mpcc import MPCC
from .method import Schedule
from .slack_form import slack_form
from .treatment import Subproblems, Treatment, with_products


@dataclass(frozen=True, kw_only=True)
class Relaxation(Treatment):
    """A sequence of regular programs whose feasible sets shrink to that of the problem."""

    schedule: Schedule = Schedule(first=1.0, factor=0.1, last=1e-8)

    def pose(self, problem: MPCC) -> Subproblems:
        """One row a pair."""
        form = slack_form(problem)
        m, sigma = form.problem, ca.SX.sym("sigma")
        return with_products(form, m.f, m.G * m.H - sigma, ca.vertcat(m.p, sigma))
