"""The states between arcs as unknowns: what the floor asks of them, and how the optimal walk moves with them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..nlp.codegen import Batch
from ..transcription.hermite import hermite_coefficients
from ..transcription.mechanical_layout import MechanicalLayout
from ..transcription.mechanical_problem import MechanicalStructure


@dataclass(frozen=True, kw_only=True, order=True)
class StateCondition:
    """y(x_k) - y(x_minus) = 0 or y(x_k) = 0 for given states x_k, y a contact position or velocity."""

    state: int
    """Index among the given states."""
    component: int
    """Index into (positions, velocities)."""
    minus: int = -1
    """Given state whose value is subtracted, -1 for none."""


def state_conditions(layout: MechanicalLayout, given_nodes: np.ndarray) -> tuple[StateCondition, ...]:
    """What planted feet ask of the states at the given nodes (n_given,): grounded, at rest, at the same place."""
    index = {int(node): k for k, node in enumerate(given_nodes)}
    found: set[StateCondition] = set()
    planted: dict[int, int] = {}  # contact component to the last given state in which it stood
    grounded: set[int] = set()
    node = 0
    for stage in layout.stages:
        planted = {i: k for i, k in planted.items() if i in stage.active}
        grounded = {i for i in (*grounded, *stage.grounded) if i in stage.active}
        for n in range(node, node + stage.n_intervals + 1):
            if n not in index:
                continue
            k = index[n]
            for i in stage.active:
                found.add(StateCondition(state=k, component=layout.n_f + i))
                if i in planted and planted[i] != k:
                    found.add(StateCondition(state=k, component=i, minus=planted[i]))
                elif i not in planted and i in grounded:
                    found.add(StateCondition(state=k, component=i))
                planted[i] = k
        node += stage.n_intervals
    return tuple(sorted(found))


@dataclass(frozen=True, eq=False)
class StateConditions:
    """The conditions as a function of all given states, divided by what counts as an error of one unit."""

    structure: MechanicalStructure
    p: np.ndarray
    """Parameters of the body, shape (n_p,)."""
    given_nodes: np.ndarray
    """Nodes with given states, shape (n_given,)."""
    place: float
    """Error of a position that counts as one [m]."""
    speed: float
    """Error of a velocity that counts as one [m/s]."""

    @cached_property
    def rows(self) -> tuple[StateCondition, ...]:
        """In the order of the values."""
        return state_conditions(self.structure.layout, self.given_nodes)

    @cached_property
    def _batches(self) -> tuple[Batch, Batch]:
        functions, n = self.structure.functions, len(self.given_nodes)
        return Batch(functions["node_values"], n), Batch(functions["node_derivatives"], n)

    def values(self, states: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values (n_rows,) and Jacobian (n_rows, n_given, 2 n_q) at given states, shape (n_given, 2 n_q)."""
        n_f = self.structure.layout.n_f
        evaluate, differentiate = self._batches
        y = evaluate(states, self.p)[0]
        slopes = differentiate(states, self.p, np.zeros((len(states), 2 * n_f)))[0]  # (n_given, 2 n_q, 2 n_f)
        values, jacobian = np.zeros(len(self.rows)), np.zeros((len(self.rows), *states.shape))
        for row, condition in enumerate(self.rows):
            i, scale = condition.component, 1.0 / (self.place if condition.component < n_f else self.speed)
            for k, sign in ((condition.state, scale), (condition.minus, -scale)):
                if k >= 0:
                    values[row] += sign * y[k, i]
                    jacobian[row, k] += sign * slopes[k, :, i]
        return values, jacobian


def coloured_moves(structure: MechanicalStructure, n_given: int) -> np.ndarray:
    """Moves of the equality constraints when given states move, shape (n_g, 2 * 2 n_q).

    An arc has a given state with an even and one with an odd index, and depends on no others: all even states move
    together in the first columns, all odd ones in the others, and nothing is mixed up.
    """
    width = 2 * structure.layout.n_q
    moves = np.zeros((structure.sparse.n_g, 2 * width))
    first = moves.shape[0] - n_given * width  # the given values are the last equalities
    for k in range(n_given):
        rows = first + k * width + np.arange(width)
        moves[rows, (k % 2) * width + np.arange(width)] = -1.0
    return moves


def spread_moves(moves: np.ndarray, given_nodes: np.ndarray) -> np.ndarray:
    """Derivatives of all states in all given states from coloured ones.

    Args:
        moves: Of the states at the nodes, shape (N + 1, 2 n_q, 2 * 2 n_q).
        given_nodes: Shape (n_given,).

    Returns:
        Shape (N + 1, 2 n_q, n_given, 2 n_q).
    """
    nodes, width = moves.shape[:2]
    coloured = moves.reshape(nodes, width, 2, width)
    full = np.zeros((nodes, width, len(given_nodes), width))
    for k, (first, last) in enumerate(zip(given_nodes[:-1], given_nodes[1:], strict=True)):
        inside = slice(first + 1, last)
        for state in (k, k + 1):
            full[inside, :, state] = coloured[inside, :, state % 2]
    full[given_nodes, :, np.arange(len(given_nodes))] = np.eye(width)
    return full


def sampling_table(node_times: np.ndarray, times: Sequence[float] | np.ndarray) -> np.ndarray:
    """Coefficients of a coordinate at times (n,) [s] in its values and rates at the nodes, shape (n, N + 1, 2)."""
    at = np.asarray(times, dtype=float)
    lengths = np.diff(node_times)
    interval = np.clip(np.searchsorted(node_times, at, side="right") - 1, 0, len(lengths) - 1)
    table = np.zeros((len(at), len(node_times), 2))
    for row, (k, t) in enumerate(zip(interval, at, strict=True)):
        share = np.array([(t - node_times[k]) / lengths[k]])
        q0, v0, q1, v1 = hermite_coefficients(share, lengths[k : k + 1])[0, 0, 0]
        table[row, k] = q0, v0
        table[row, k + 1] = q1, v1
    return table
