"""Minimax problems from expressions."""

from dataclasses import dataclass, field

import casadi as ca
import numpy as np


class SymbolicMinimax:
    """min max_i h_i(w) subject to phi(w) = 0 and bounds, h and phi lists of expressions of w."""

    def __init__(self, n, build, lower=None, upper=None):
        w = ca.SX.sym("w", n)
        h, phi = build(w)
        h, phi = ca.vertcat(*h), ca.vertcat(ca.SX(0, 1), *phi)
        mu, lam = ca.SX.sym("mu", h.numel()), ca.SX.sym("lam", phi.numel())
        self.lbw = np.full(n, -np.inf) if lower is None else np.array(lower, float)
        self.ubw = np.full(n, np.inf) if upper is None else np.array(upper, float)
        self.functions = ca.Function("f", [w], [h, ca.jacobian(h, w), phi, ca.jacobian(phi, w)])
        self.curvature = ca.Function("c", [w, mu, lam], [ca.hessian(ca.dot(mu, h) + ca.dot(lam, phi), w)[0]])

    def evaluate(self, w):
        h, G, phi, A = (out.full() for out in self.functions(w))
        return SymbolicPoint(self, w, h.ravel(), G, phi.ravel(), A)


@dataclass(eq=False)
class SymbolicPoint:
    problem: SymbolicMinimax
    w: np.ndarray
    values: np.ndarray
    gradients: np.ndarray
    equality: np.ndarray
    equality_jacobian: np.ndarray
    is_peak: np.ndarray = field(init=False)
    measure: np.ndarray = field(init=False)

    def __post_init__(self):
        self.is_peak = np.ones(len(self.values), dtype=bool)
        self.measure = np.full(len(self.values), 1.0 / len(self.values))

    def hessian(self, mu, lam):
        return self.problem.curvature(self.w, mu, lam).full()


def charalambous_bandler(w):
    return [w[0] ** 2 + w[1] ** 4, (2 - w[0]) ** 2 + (2 - w[1]) ** 2, 2 * ca.exp(w[1] - w[0])], []


def rosen_suzuki(w):
    a, b, c, d = (w[i] for i in range(4))
    f = a**2 + b**2 + 2 * c**2 + d**2 - 5 * a - 5 * b - 21 * c + 7 * d
    limits = [
        a**2 + b**2 + c**2 + d**2 + a - b + c - d - 8,
        a**2 + 2 * b**2 + c**2 + 2 * d**2 - a - d - 10,
        2 * a**2 + b**2 + c**2 + 2 * a - b - d - 5,
    ]
    return [f, *(f + 10 * limit for limit in limits)], []


def on_the_circle(w):
    return [w[0], w[1], -w[0] - w[1]], [ca.sumsqr(w) - 2.0]
