"""One call of Uno through CasADi, in whatever process it is made."""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from .problem import Bounds

UnoOptions = dict[str, bool | dict[str, str | float | int]]


@dataclass(frozen=True, kw_only=True)
class UnoProblem:
    """What stays the same from solve to solve."""

    functions: str
    """Serialised function (w, p) -> (f, g)."""
    options: UnoOptions


@dataclass(frozen=True, kw_only=True)
class UnoRequest:
    """One solve."""

    w0: np.ndarray
    """Start, shape (n_w,)."""
    p: np.ndarray
    """Parameters, shape (n_p,)."""
    lam_w0: np.ndarray
    """Multipliers of the bounds to start from, shape (n_w,)."""
    lam_g0: np.ndarray
    """Multipliers of the constraints to start from, shape (n_g,)."""
    bounds: Bounds


@dataclass(frozen=True, kw_only=True)
class UnoAnswer:
    """What Uno returned, unchecked."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    lam_w: np.ndarray
    """Multipliers, shape (n_w,)."""
    lam_g: np.ndarray
    """Multipliers, shape (n_g,)."""
    f: float
    status: str
    code: str
    """CasADi's return code."""
    iterations: int


def no_answer(request: UnoRequest, status: str, code: str) -> UnoAnswer:
    """The start of a solve that returned nothing."""
    return UnoAnswer(
        w=request.w0,
        lam_w=np.zeros(request.lam_w0.size),
        lam_g=np.zeros(request.lam_g0.size),
        f=float("nan"),
        status=status,
        code=code,
        iterations=0,
    )


class UnoCall:
    """Uno bound to one problem."""

    def __init__(self, problem: UnoProblem) -> None:
        functions = ca.Function.deserialize(problem.functions)
        w, p = (ca.SX.sym(name, functions.numel_in(i)) for i, name in enumerate("wp"))
        f, g = functions(w, p)
        self._solver = ca.nlpsol("solver", "uno", {"x": w, "p": p, "f": f, "g": g}, problem.options)

    def __call__(self, request: UnoRequest) -> UnoAnswer:
        """Solve once. An exception from Uno's inside is an answer: the start, and what was said."""
        bounds = request.bounds
        try:
            out = self._solver(
                x0=request.w0, p=request.p, lam_x0=request.lam_w0, lam_g0=request.lam_g0,
                lbx=bounds.lbw, ubx=bounds.ubw, lbg=bounds.lbg, ubg=bounds.ubg,
            )  # fmt: skip
        except RuntimeError as error:
            reason = str(error).strip().splitlines()[-1].split(": ", 1)[-1]
            return no_answer(request, f"Uno gave up: {reason}", "exception")
        stats = self._solver.stats()
        w, lam_w, lam_g = (np.asarray(out[key]).ravel() for key in ("x", "lam_x", "lam_g"))
        return UnoAnswer(
            w=w,
            lam_w=lam_w,
            lam_g=lam_g,
            f=float(out["f"]),
            status=str(stats["return_status"]),
            code=str(stats["unified_return_status"]),
            iterations=int(stats["iter_count"]),
        )
