"""First and second derivatives of a nonlinear program as functions, however they were made."""

from dataclasses import dataclass

import casadi as ca

from .codegen import compile_functions


@dataclass(frozen=True, kw_only=True, eq=False)
class NLPDerivatives:
    r"""Derivatives of f(w, p) and g(w, p), with the Lagrangian :math:`L = \lambda_f f + \lambda_g^T g`.

    The first three have the names, arguments and results that `casadi.nlpsol` expects of its options `grad_f`,
    `jac_g` and `hess_lag`.
    """

    gradient: ca.Function
    """(w, p) -> (f, df/dw), shapes (1, 1), (n_w, 1)."""
    jacobian: ca.Function
    """(w, p) -> (g, dg/dw), shapes (n_g, 1), (n_g, n_w)."""
    hessian: ca.Function
    """(w, p, lam_f, lam_g) -> upper triangle of the Hessian of L in w, shape (n_w, n_w)."""
    mixed: ca.Function
    """(w, p, lam_f, lam_g) -> (d2L/dw dp, dg/dp), shapes (n_w, n_p), (n_g, n_p)."""

    def solver_options(self) -> dict[str, ca.Function | bool]:
        """Options that make `casadi.nlpsol` use these functions."""
        functions = {"grad_f": self.gradient, "jac_g": self.jacobian, "hess_lag": self.hessian}
        return functions | {"no_nlp_grad": True, "calc_lam_p": False}

    def compiled(self) -> "NLPDerivatives":
        """The same functions as machine code, where there is a C compiler; they are compiled once and cached."""
        functions = (self.gradient, self.jacobian, self.hessian, self.mixed)
        gradient, jacobian, hessian, mixed = (
            compile_functions(functions, "nlp_derivatives")[function.name()] for function in functions
        )
        return NLPDerivatives(gradient=gradient, jacobian=jacobian, hessian=hessian, mixed=mixed)


_POINT, _LAGRANGIAN = ["x", "p"], ["x", "p", "lam_f", "lam_g"]
_GRADIENT, _JACOBIAN, _HESSIAN = ["f", "grad_f_x"], ["g", "jac_g_x"], ["triu_hess_gamma_x_x"]
_MIXED = ["hess_gamma_x_p", "jac_g_p"]


def derivatives_from(inputs: list[ca.MX], results: dict[str, list[ca.MX]]) -> NLPDerivatives:
    """Wrap expressions of (w, p, lam_f, lam_g), under the names of the fields of `NLPDerivatives`."""
    point = inputs[:2]
    return NLPDerivatives(
        gradient=ca.Function("nlp_grad_f", point, results["gradient"], _POINT, _GRADIENT),
        jacobian=ca.Function("nlp_jac_g", point, results["jacobian"], _POINT, _JACOBIAN),
        hessian=ca.Function("nlp_hess_l", inputs, results["hessian"], _LAGRANGIAN, _HESSIAN),
        mixed=ca.Function("nlp_mixed", inputs, results["mixed"], _LAGRANGIAN, _MIXED),
    )


def differentiate(w: ca.SX, p: ca.SX, f: ca.SX, g: ca.SX) -> NLPDerivatives:
    """Differentiate the whole problem at once: simple, and slow where the problem is a long chain of stages."""
    lam_f, lam_g = ca.SX.sym("lam_f"), ca.SX.sym("lam_g", g.numel())
    slope = ca.gradient(lam_f * f + ca.dot(lam_g, g), w)
    hessian = ca.triu(ca.jacobian(slope, w, {"symmetric": True}))
    inputs, mixed = [w, p, lam_f, lam_g], [ca.jacobian(slope, p), ca.jacobian(g, p)]
    return NLPDerivatives(
        gradient=ca.Function("nlp_grad_f", [w, p], [f, ca.gradient(f, w)], _POINT, _GRADIENT),
        jacobian=ca.Function("nlp_jac_g", [w, p], [g, ca.jacobian(g, w)], _POINT, _JACOBIAN),
        hessian=ca.Function("nlp_hess_l", inputs, [hessian], _LAGRANGIAN, _HESSIAN),
        mixed=ca.Function("nlp_mixed", inputs, mixed, _LAGRANGIAN, _MIXED),
    )
