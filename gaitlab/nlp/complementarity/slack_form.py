"""Pairs of plain variables: each half that is more than one variable gets a slack of its own.

Solvers then keep the signs of the pairs exactly, as bounds (Fletcher, Leyffer, Ralph, Scholtes 2006, section 2).
"""

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from ..mpcc import MPCC


@dataclass(frozen=True, kw_only=True)
class SlackForm:
    """An MPCC whose pairs have their signs by bounds on variables."""

    problem: MPCC
    """Variables (w, s); each half of a pair depends on one of them."""
    n_slacks: int
    start: ca.SX
    """(w, consistent s) as an expression of (w, p), shape (n_w + n_s, 1)."""


def slack_form(problem: MPCC) -> SlackForm:
    """Give slacks to the halves of pairs that are not plain variables."""
    builder = _Builder(problem=problem, lbw=problem.lbw.copy(), ubw=problem.ubw.copy())
    first, second = builder.half(problem.G), builder.half(problem.H)
    symbols = ca.vertcat(*builder.symbols, ca.SX(0, 1))
    expressions = ca.vertcat(*builder.expressions, ca.SX(0, 1))
    zeros = np.zeros(symbols.numel())
    extended = MPCC(
        w=ca.vertcat(problem.w, symbols),
        p=problem.p,
        f=problem.f,
        residual=problem.residual,
        g=ca.vertcat(problem.g, expressions - symbols),
        G=first,
        H=second,
        lbw=np.concatenate([builder.lbw, zeros]),
        ubw=np.concatenate([builder.ubw, zeros + np.inf]),
        lbg=np.concatenate([problem.lbg, zeros]),
        ubg=np.concatenate([problem.ubg, zeros]),
    )
    return SlackForm(problem=extended, n_slacks=zeros.size, start=ca.vertcat(problem.w, ca.fmax(expressions, 0.0)))


@dataclass(kw_only=True)
class _Builder:
    problem: MPCC
    lbw: np.ndarray
    """Lower bounds with the signs of plain halves, shape (n_w,)."""
    ubw: np.ndarray
    """Upper bounds with the signs of plain halves, shape (n_w,)."""
    symbols: list[ca.SX] = field(default_factory=list[ca.SX])
    expressions: list[ca.SX] = field(default_factory=list[ca.SX])

    def half(self, half: ca.SX) -> ca.SX:
        """One half of the pairs, with slacks where needed."""
        plain = _plain_rows(self.problem, half)
        rows: list[ca.SX] = []
        for i in range(half.numel()):
            if i in plain and self._bounded(*plain[i]):
                rows.append(half[i])
                continue
            slack = ca.SX.sym(f"s{len(self.symbols)}")
            self.symbols.append(slack)
            self.expressions.append(half[i])
            rows.append(slack)
        return ca.vertcat(*rows, ca.SX(0, 1))

    def _bounded(self, variable: int, slope: float, offset: float) -> bool:
        """Make slope * w + offset >= 0 a bound, unless the bounds would cross."""
        bound = -offset / slope
        if slope > 0.0 and bound <= self.ubw[variable]:
            self.lbw[variable] = max(self.lbw[variable], bound)
            return True
        if slope < 0.0 and bound >= self.lbw[variable]:
            self.ubw[variable] = min(self.ubw[variable], bound)
            return True
        return False


def _plain_rows(problem: MPCC, half: ca.SX) -> dict[int, tuple[int, float, float]]:
    """Rows a * w_j + b with numbers a, not zero, and b: their j, a and b."""
    jacobian = ca.jacobian(half, problem.w)
    rows, columns = (np.array(indices, dtype=int) for indices in jacobian.sparsity().get_triplet())
    values = ca.Function("plain", [problem.w, problem.p], [jacobian, half])
    entries, offsets = values(np.zeros(problem.w.numel()), np.zeros(problem.p.numel()))
    slopes = np.array(entries.nonzeros())
    counts = np.bincount(rows, minlength=half.numel())
    found: dict[int, tuple[int, float, float]] = {}
    for k, i in enumerate(rows):
        alone = counts[i] == 1 and slopes[k] != 0.0 and jacobian.nz[k].is_constant()
        if alone and not ca.depends_on(half[int(i)], problem.p):
            found[int(i)] = (int(columns[k]), float(slopes[k]), float(offsets[int(i)]))
    return found
