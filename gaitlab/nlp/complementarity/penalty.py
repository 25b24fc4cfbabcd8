"""Exact penalty: f + rho G'H over G >= 0, H >= 0 (Ralph and Wright 2004; Leyffer, Lopez-Calva, Nocedal 2006)."""

from dataclasses import dataclass

import casadi as ca

from ..mpcc import MPCC
from .method import Schedule
from .slack_form import slack_form
from .treatment import Subproblems, Treatment, with_products


@dataclass(frozen=True, kw_only=True)
class Penalty(Treatment):
    """The product is the l1-norm of the complementarity; a finite weight makes it vanish."""

    schedule: Schedule = Schedule(first=1.0, factor=10.0, last=1e8)

    def pose(self, problem: MPCC) -> Subproblems:
        """No product among the constraints."""
        form = slack_form(problem)
        m, rho = form.problem, ca.SX.sym("rho")
        return with_products(form, m.f + rho * ca.dot(m.G, m.H), ca.SX(0, 1), ca.vertcat(m.p, rho))
