"""One sentence on why a nonlinear program was not solved: which constraint or variable is to blame."""

import casadi as ca
import numpy as np

from .derivatives import differentiate
from .outcome import Outcome
from .problem import NLP

FAR = 1e8
"""A variable beyond this has run away."""


def blame(nlp: NLP, w: np.ndarray, p: np.ndarray, outcome: Outcome) -> str:
    """Explain an end at w, shape (n_w,), for parameters p, shape (n_p,), by index of constraint or variable."""
    f, g = (np.asarray(out).ravel() for out in ca.Function("values", [nlp.w, nlp.p], [nlp.f, nlp.g])(w, p))
    invalid = invalid_function(nlp, w, p)
    if invalid is not None:
        return invalid
    if outcome is Outcome.UNBOUNDED or np.max(np.abs(w), initial=0.0) > FAR:
        i = int(np.argmax(np.abs(w)))
        return f"the objective falls to {f[0]:.3g} while w[{i}] runs to {w[i]:.3g}: it needs a bound"
    worst, sentence = _worst_violation(nlp, w, g)
    if worst > 1e-6:
        return sentence
    dependent = dependent_constraint(nlp, w, p)
    if dependent is not None:
        return f"constraint g[{dependent}] depends linearly on the others: the Jacobian has lost rank"
    return str(outcome)


def invalid_function(nlp: NLP, w: np.ndarray, p: np.ndarray) -> str | None:
    """Name a function or gradient that is not finite at w, shape (n_w,), p, shape (n_p,); None where all are."""
    derivatives = nlp.derivatives or differentiate(nlp.w, nlp.p, nlp.f, nlp.g)
    (f, grad), (g, jacobian) = derivatives.gradient(w, p), derivatives.jacobian(w, p)
    slopes = ca.mtimes(jacobian, ca.DM.ones(nlp.w.numel()))
    f, g, grad, slopes = (np.asarray(out.full()).ravel() for out in (f, g, grad, slopes))
    for name, values in [("the objective", f), ("constraint g[{}]", g)]:
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            return f"{name.format(bad[0])} is {values[bad[0]]} at this point"
    for name, values in [("objective with respect to w[{}]", grad), ("constraint g[{}]", slopes)]:
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            return f"the derivative of {name.format(bad[0])} is {values[bad[0]]} at this point"
    return None


def dependent_constraint(nlp: NLP, w: np.ndarray, p: np.ndarray) -> int | None:
    """Index of an equality whose gradient depends on the others' at w, shape (n_w,), p, shape (n_p,).

    None where the Jacobian of equalities has full rank on the variables that their bounds leave free.
    """
    equal = np.flatnonzero(nlp.lbg == nlp.ubg)
    free = np.flatnonzero(nlp.lbw < nlp.ubw)
    if not equal.size:
        return None
    jacobian = ca.Function("jacobian", [nlp.w, nlp.p], [ca.jacobian(nlp.g, nlp.w)])(w, p)
    dense = np.asarray(jacobian.full())[np.ix_(equal, free)]
    scale = np.maximum(np.abs(dense).max(axis=1, initial=0.0), np.finfo(float).tiny)
    left, strengths, _ = np.linalg.svd(dense / scale[:, None])
    rank = int(np.sum(strengths > 1e-10 * max(strengths.max(initial=0.0), np.finfo(float).tiny)))
    if rank == len(equal):
        return None
    return int(equal[np.argmax(np.abs(left[:, -1]))])


def _worst_violation(nlp: NLP, w: np.ndarray, g: np.ndarray) -> tuple[float, str]:
    violations = {
        "g": np.maximum(np.maximum(nlp.lbg - g, g - nlp.ubg), 0.0),
        "w": np.maximum(np.maximum(nlp.lbw - w, w - nlp.ubw), 0.0),
    }
    name = max(violations, key=lambda key: float(violations[key].max(initial=0.0)))
    if not violations[name].size:
        return 0.0, ""
    i = int(np.argmax(violations[name]))
    worst = float(violations[name][i])
    value, lower, upper = (g[i], nlp.lbg[i], nlp.ubg[i]) if name == "g" else (w[i], nlp.lbw[i], nlp.ubw[i])
    return worst, f"{name}[{i}] = {value:.6g} misses its bounds [{lower:.6g}, {upper:.6g}] by {worst:.3g}"
