"""A `SparseProblem` from a few expressions, in one block, all derivatives by CasADi."""

import casadi as ca
import numpy as np

from gaitlab.nlp.sparse_problem import Derivatives, Pattern, SparseStructure, Values


def full_pattern(n_rows, n_cols):
    rows, cols = np.indices((n_rows, n_cols))
    return Pattern(rows.ravel(), cols.ravel())


class SymbolicProgram:
    """Minimise f subject to g = 0 and c >= 0, functions of the vector x."""

    def __init__(self, x, f, g=(), c=()):
        g, c = ca.vertcat(*g, ca.SX(0, 1)), ca.vertcat(*c, ca.SX(0, 1))
        n_w, n_g, n_c = x.numel(), g.numel(), c.numel()
        lam_g, lam_c = ca.SX.sym("lam_g", n_g), ca.SX.sym("lam_c", n_c)
        lagrangian = f + ca.dot(lam_g, g) - ca.dot(lam_c, c)
        derivatives = [ca.gradient(f, x), ca.jacobian(g, x), ca.jacobian(c, x), ca.hessian(lagrangian, x)[0]]
        self._values = ca.Function("values", [x], [f, g, c])
        self._derivatives = ca.Function("derivatives", [x, lam_g, lam_c], derivatives)
        self.structure = SparseStructure(
            n_w=n_w,
            n_g=n_g,
            n_c=n_c,
            jac_g=full_pattern(n_g, n_w),
            jac_c=full_pattern(n_c, n_w),
            hess=full_pattern(n_w, n_w),
            order=np.arange(n_w + n_g),
            blocks=np.array([n_w + n_g]),
        )

    def values(self, w):
        f, g, c = (np.array(out).ravel() for out in self._values(w))
        return Values(float(f[0]), g, c)

    def derivatives(self, w, lam_g, lam_c):
        return Derivatives(*(np.array(out).ravel() for out in self._derivatives(w, lam_g, lam_c)))
