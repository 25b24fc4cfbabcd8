"""Reads AMPL's text `.nl` files with complementarity constraints (Gay, Writing .nl files, 2005).

CasADi's reader refuses complementarity. A row `5 k i` of the segment of constraint bounds says that the body of this
constraint complements variable i - 1, with bit 1 of k set where that variable has a finite lower bound and bit 2 where
it has a finite upper bound. Such rows are declared free, the file is imported, and the pairs are attached again:

* k = 1: 0 <= body perp v - lower >= 0
* k = 2: 0 <= -body perp upper - v >= 0
* k = 3: body = s+ - s-, 0 <= s+ perp v - lower >= 0, 0 <= s- perp upper - v >= 0
* k = 0: body = 0
"""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.mpcc import MPCC
from .mpcc_problem import NamedMPCC

LOWER, UPPER = 1, 2


def read_ampl(path: Path) -> NamedMPCC:
    """Problem of a text `.nl` file.

    Raises:
        ProblemError: The file is binary, damaged, or uses what CasADi's reader does not know.
    """
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise ProblemError(f"{path}: not a text .nl file") from error
    if not text.startswith("g"):
        raise ProblemError(f"{path}: not a text .nl file; write it with AMPL's option g")
    lines, pairs = _without_pairs(path, text.splitlines())
    program = _import(path, "\n".join(lines) + "\n")
    return NamedMPCC(name=path.stem, problem=_with_pairs(path, program, pairs), w0=program.w0, sense=_sense(lines))


@dataclass(frozen=True, kw_only=True)
class _Pair:
    row: int
    variable: int
    bounds: int


@dataclass(frozen=True, kw_only=True)
class _Program:
    w: ca.SX
    f: ca.SX
    g: ca.SX
    bounds: dict[str, np.ndarray] = field(repr=False)
    """lbw, ubw, lbg, ubg, shapes (n_w,) and (n_g,)."""
    w0: np.ndarray
    """Start, shape (n_w,)."""


def _without_pairs(path: Path, lines: list[str]) -> tuple[list[str], list[_Pair]]:
    try:
        n_w, n_g = (int(word) for word in lines[1].split()[:2])
        first = next(i for i, line in enumerate(lines) if line.split("#")[0].strip() == "r") + 1
    except (IndexError, ValueError, StopIteration) as error:
        raise ProblemError(f"{path}: the file has no readable header or no segment of constraint bounds") from error
    kept, pairs = list(lines), list[_Pair]()
    for row in range(n_g):
        words = lines[first + row].split("#")[0].split() if first + row < len(lines) else []
        if words[:1] != ["5"]:
            continue
        if len(words) != 3 or not 1 <= int(words[2]) <= n_w:
            raise ProblemError(f"{path}: row {row} complements variable {words[2:]}, there are {n_w}")
        pairs.append(_Pair(row=row, variable=int(words[2]) - 1, bounds=int(words[1]) & (LOWER | UPPER)))
        kept[first + row] = "3"
    return kept, pairs


def _import(path: Path, text: str) -> _Program:
    builder = ca.NlpBuilder()
    with tempfile.TemporaryDirectory(prefix="gaitlab-") as folder:
        plain = Path(folder) / "plain.nl"
        plain.write_text(text)
        try:
            builder.import_nl(str(plain))
        except (RuntimeError, ValueError) as error:
            raise ProblemError(f"{path}: {str(error).strip().splitlines()[-1]}") from error
    x = ca.vertcat(*builder.x)
    functions = ca.Function("functions", [x], [builder.f, ca.vertcat(*builder.g, ca.MX(0, 1))])
    w = ca.SX.sym("w", x.numel())
    f, g = functions.expand()(w)
    sides = {"lbw": builder.x_lb, "ubw": builder.x_ub, "lbg": builder.g_lb, "ubg": builder.g_ub}
    bounds = {name: np.array(values, dtype=float) for name, values in sides.items()}
    return _Program(w=w, f=f, g=ca.densify(g), bounds=bounds, w0=np.array(builder.x_init, dtype=float))


def _sense(lines: list[str]) -> int:
    """1 where the objective is minimised, -1 where it is maximised."""
    first = next((line.split("#")[0].split() for line in lines if line.startswith("O")), ["O0", "0"])
    return -1 if first[1] == "1" else 1


def _with_pairs(path: Path, program: _Program, pairs: list[_Pair]) -> MPCC:
    rows = _Rows(program)
    for pair in pairs:
        lower, upper = program.bounds["lbw"][pair.variable], program.bounds["ubw"][pair.variable]
        promised = [(LOWER, lower), (UPPER, upper)]
        if any(pair.bounds & bit and not np.isfinite(bound) for bit, bound in promised):
            raise ProblemError(f"{path}: row {pair.row} complements a bound that w[{pair.variable}] does not have")
        rows.add(pair, lower, upper)
    complementing = {pair.row for pair in pairs}
    kept = [i for i in range(program.g.numel()) if i not in complementing]
    n_s = len(rows.slacks)
    return MPCC(
        w=ca.vertcat(program.w, *rows.slacks),
        f=program.f,
        g=ca.vertcat(*(program.g[i] for i in kept), *rows.equal, ca.SX(0, 1)),
        G=ca.vertcat(*rows.first, ca.SX(0, 1)),
        H=ca.vertcat(*rows.second, ca.SX(0, 1)),
        lbw=np.append(program.bounds["lbw"], np.zeros(n_s)),
        ubw=np.append(program.bounds["ubw"], np.full(n_s, np.inf)),
        lbg=np.append(program.bounds["lbg"][kept], np.zeros(len(rows.equal))),
        ubg=np.append(program.bounds["ubg"][kept], np.zeros(len(rows.equal))),
    )


class _Rows:
    """Pairs, and the equations and slacks that two-sided ones need."""

    def __init__(self, program: _Program) -> None:
        self._program = program
        self.first: list[ca.SX] = []
        self.second: list[ca.SX] = []
        self.equal: list[ca.SX] = []
        self.slacks: list[ca.SX] = []

    def add(self, pair: _Pair, lower: float, upper: float) -> None:
        body, variable = self._program.g[pair.row], self._program.w[pair.variable]
        if pair.bounds == LOWER:
            self._pair(body, variable - lower)
        elif pair.bounds == UPPER:
            self._pair(-body, upper - variable)
        elif pair.bounds == LOWER | UPPER:
            above, below = (ca.SX.sym(f"s{len(self.slacks) + k}") for k in (0, 1))
            self.slacks += [above, below]
            self.equal.append(body - above + below)
            self._pair(above, variable - lower)
            self._pair(below, upper - variable)
        else:
            self.equal.append(body)

    def _pair(self, first: ca.SX, second: ca.SX) -> None:
        self.first.append(first)
        self.second.append(second)
