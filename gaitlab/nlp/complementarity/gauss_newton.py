"""Generalised Gauss-Newton derivatives of a constrained least-squares problem (Bock 1987; Hatz 2014, section 5.5)."""

from dataclasses import replace

import casadi as ca

from ..derivatives import NLPDerivatives, differentiate
from ..problem import NLP


def gauss_newton_derivatives(nlp: NLP, residual: ca.SX, rest: ca.SX) -> NLPDerivatives:
    r"""Derivatives of `nlp`, whose objective is half the squares of `residual`, shape (n_m, 1), plus `rest`.

    The Hessian of the Lagrangian is :math:`\lambda_f (J^T J + \nabla^2 \text{rest})`, without the curvature of
    residual and constraints.
    """
    lam_f, lam_g = ca.SX.sym("lam_f"), ca.SX.sym("lam_g", nlp.g.numel())
    J = ca.jacobian(residual, nlp.w)
    hessian = lam_f * (ca.mtimes(J.T, J) + ca.hessian(rest, nlp.w)[0])
    names = ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
    function = ca.Function("nlp_hess_l", [nlp.w, nlp.p, lam_f, lam_g], [ca.triu(hessian)], *names)
    return replace(differentiate(nlp.w, nlp.p, nlp.f, nlp.g), hessian=function)
