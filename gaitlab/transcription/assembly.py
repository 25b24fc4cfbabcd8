"""Nonlinear programs put together from small pieces, and their derivatives piece by piece.

A piece is a function of few unknowns that occurs many times, for instance once per interval. Only pieces are
differentiated; their Jacobians and Hessians are scattered into the sparse matrices of the whole, so the cost is linear
in the number of intervals and nothing is coloured.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.derivatives import NLPDerivatives, derivatives_from
from ..nlp.problem import NLP


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """A function that occurs n times, every time with other unknowns and data.

    Raises:
        ProblemError: Shapes do not fit together.
    """

    function: ca.Function
    """(z, d, p) -> (f, g): its share of the objective, and its constraints."""
    unknowns: np.ndarray
    """Places of z in w, all different within a row, shape (n, n_z)."""
    data: np.ndarray
    """Values of d, shape (n, n_d)."""
    lower: np.ndarray
    """Lower bounds on g, shape (n, n_g)."""
    upper: np.ndarray
    """Upper bounds on g, shape (n, n_g)."""
    labels: tuple[str, ...]
    """What each constraint says, n times n_g names, occurrence by occurrence."""

    def __post_init__(self) -> None:
        f, n = self.function, len(self.unknowns)
        expected = [(n, f.numel_in(0)), (n, f.numel_in(1)), (n, f.numel_out(1)), (n, f.numel_out(1))]
        shapes = [self.unknowns.shape, self.data.shape, self.lower.shape, self.upper.shape]
        if shapes != expected or len(self.labels) != n * f.numel_out(1):
            raise ProblemError(f"piece {f.name()}: unknowns, data and bounds must have shapes {expected}, got {shapes}")

    @property
    def n(self) -> int:
        """How often it occurs."""
        return len(self.unknowns)

    @property
    def n_g(self) -> int:
        """Constraints per occurrence."""
        return self.function.numel_out(1)

    @cached_property
    def derivatives(self) -> "PieceDerivatives":
        """Derivatives of one occurrence."""
        return PieceDerivatives(self.function)


class PieceDerivatives:
    """Nonzero entries of the derivatives of one occurrence of a piece, as functions, with their places."""

    def __init__(self, function: ca.Function) -> None:
        z, d, p = (ca.SX.sym(name, function.numel_in(i)) for i, name in enumerate("zdp"))
        f, g = function(z, d, p)
        lam_f, lam_g = ca.SX.sym("lam_f"), ca.SX.sym("lam_g", g.numel())
        slope = ca.gradient(lam_f * f + ca.dot(lam_g, g), z)
        jacobian, hessian = ca.jacobian(g, z), ca.triu(ca.jacobian(slope, z, {"symmetric": True}))
        mixed, jacobian_p = ca.jacobian(slope, p), ca.jacobian(g, p)
        point, lagrangian = [z, d, p], [z, d, p, lam_f, lam_g]
        self.gradient = ca.Function("gradient", point, [f, ca.densify(ca.gradient(f, z))])
        self.jacobian = ca.Function("jacobian", point, [ca.densify(g), _entries(jacobian)])
        self.hessian = ca.Function("hessian", lagrangian, [_entries(hessian)])
        self.mixed = ca.Function("mixed", lagrangian, [_entries(mixed), _entries(jacobian_p)])
        self.at_jacobian, self.at_hessian = _places(jacobian), _places(hessian)
        self.at_mixed, self.at_jacobian_p = _places(mixed), _places(jacobian_p)


def _entries(matrix: ca.SX) -> ca.SX:
    return matrix.nz[:] if matrix.nnz() else ca.SX(0, 1)


def _places(matrix: ca.SX) -> tuple[np.ndarray, np.ndarray]:
    rows, columns = matrix.sparsity().get_triplet()
    return np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)


@dataclass(frozen=True, kw_only=True, eq=False)
class Assembly:
    """The whole problem as pieces over w and p."""

    w: ca.SX
    """Unknowns, shape (n_w, 1)."""
    p: ca.SX
    """Parameters, shape (n_p, 1)."""
    pieces: tuple[Piece, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """What each constraint says, in the order of g."""
        return tuple(label for piece in self.pieces for label in piece.labels)

    def nlp(self, lbw: np.ndarray, ubw: np.ndarray) -> NLP:
        """The nonlinear program with bounds of shape (n_w,) on w, and with derivatives assembled from the pieces."""
        f, g = ca.SX(0), [ca.SX(0, 1)]
        for piece in self.pieces:
            for unknowns, data in zip(piece.unknowns, piece.data, strict=True):
                f_piece, g_piece = piece.function(self.w[unknowns.tolist()], data, self.p)
                f, g = f + f_piece, [*g, g_piece]
        return NLP(
            w=self.w,
            p=self.p,
            f=f,
            g=ca.densify(ca.vertcat(*g)),
            lbw=lbw,
            ubw=ubw,
            lbg=np.concatenate([np.zeros(0), *[piece.lower.ravel() for piece in self.pieces]]),
            ubg=np.concatenate([np.zeros(0), *[piece.upper.ravel() for piece in self.pieces]]),
            derivatives=self.derivatives(),
        )

    def derivatives(self) -> NLPDerivatives:
        """Derivatives of the whole, evaluated piece by piece."""
        n_w, n_p = self.w.numel(), self.p.numel()
        n_g = sum(piece.n * piece.n_g for piece in self.pieces)
        w, p = ca.MX.sym("w", n_w), ca.MX.sym("p", n_p)
        lam_f, lam_g = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", n_g)
        f, g, gradient = ca.MX(0), [ca.MX(0, 1)], _Scatter(n_w, 1)
        jacobian, hessian = _Scatter(n_g, n_w), _Scatter(n_w, n_w)
        mixed, jacobian_p = _Scatter(n_w, n_p), _Scatter(n_g, n_p)
        for piece, rows in zip(self.pieces, _constraint_places(self.pieces), strict=True):
            call, at, unknowns = _Call(piece, w, p, (lam_f, lam_g, rows)), piece.derivatives, piece.unknowns
            f_piece, gradient_piece = call.at_point(at.gradient)
            g_piece, jacobian_piece = call.at_point(at.jacobian)
            (hessian_piece,) = call.of_lagrangian(at.hessian)
            mixed_piece, jacobian_p_piece = call.of_lagrangian(at.mixed)
            f, g = f + ca.sum2(f_piece), [*g, ca.vec(g_piece)]
            gradient.add(unknowns, np.zeros_like(unknowns), gradient_piece)
            jacobian.add(rows[:, at.at_jacobian[0]], unknowns[:, at.at_jacobian[1]], jacobian_piece)
            ends = unknowns[:, at.at_hessian[0]], unknowns[:, at.at_hessian[1]]
            hessian.add(np.minimum(*ends), np.maximum(*ends), hessian_piece)
            mixed.add(unknowns[:, at.at_mixed[0]], _shared(at.at_mixed[1], piece.n), mixed_piece)
            jacobian_p.add(rows[:, at.at_jacobian_p[0]], _shared(at.at_jacobian_p[1], piece.n), jacobian_p_piece)
        results = {
            "gradient": [f, ca.densify(gradient.matrix())],
            "jacobian": [ca.vertcat(*g), jacobian.matrix()],
            "hessian": [hessian.matrix()],
            "mixed": [mixed.matrix(), jacobian_p.matrix()],
        }
        return derivatives_from([w, p, lam_f, lam_g], results)


class _Call:
    """All occurrences of one piece at once; columns are occurrences."""

    def __init__(self, piece: Piece, w: ca.MX, p: ca.MX, multipliers: tuple[ca.MX, ca.MX, np.ndarray]) -> None:
        self.n = piece.n
        lam_f, lam_g, rows = multipliers
        z = ca.reshape(w[piece.unknowns.ravel().tolist()], piece.unknowns.shape[1], piece.n)
        self.point = [z, ca.MX(ca.DM(piece.data.T)), ca.repmat(p, 1, piece.n)]
        lam = ca.reshape(lam_g[rows.ravel().tolist()], rows.shape[1], piece.n)
        self.lagrangian = [*self.point, ca.repmat(lam_f, 1, piece.n), lam]

    def at_point(self, function: ca.Function) -> list[ca.MX]:
        return function.map(self.n).call(self.point)

    def of_lagrangian(self, function: ca.Function) -> list[ca.MX]:
        return function.map(self.n).call(self.lagrangian)


class _Scatter:
    """Sum of entries at given places of a sparse matrix."""

    def __init__(self, n_rows: int, n_columns: int) -> None:
        self.shape = (n_rows, n_columns)
        self.places: list[np.ndarray] = [np.zeros(0, dtype=np.int64)]
        self.entries: list[ca.MX] = [ca.MX(0, 1)]

    def add(self, rows: np.ndarray, columns: np.ndarray, entries: ca.MX) -> None:
        # Column-major places, so that sorting them gives CasADi's compressed columns.
        self.places.append((columns * max(self.shape[0], 1) + rows).ravel())
        self.entries.append(ca.vec(entries))

    def matrix(self) -> ca.MX:
        places, slots = np.unique(np.concatenate(self.places), return_inverse=True)
        sparsity = ca.Sparsity.triplet(
            *self.shape, (places % max(self.shape[0], 1)).tolist(), (places // max(self.shape[0], 1)).tolist()
        )
        entries = ca.vertcat(*self.entries)
        if places.size == 0:
            return ca.MX(*self.shape)
        if places.size == slots.size:
            return ca.MX(sparsity, entries[np.argsort(slots).tolist()])
        add_up = ca.DM(
            ca.Sparsity.triplet(places.size, slots.size, slots.tolist(), list(range(slots.size))),
            ca.DM.ones(slots.size),
        )
        return ca.MX(sparsity, ca.mtimes(add_up, entries))


def _constraint_places(pieces: Sequence[Piece]) -> list[np.ndarray]:
    """Rows of g of each piece, shape (n, n_g) each."""
    rows, first = list[np.ndarray](), 0
    for piece in pieces:
        rows.append(first + np.arange(piece.n * piece.n_g).reshape(piece.n, piece.n_g))
        first += piece.n * piece.n_g
    return rows


def _shared(places: np.ndarray, n: int) -> np.ndarray:
    return np.tile(places, (n, 1))
