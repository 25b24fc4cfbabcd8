"""Criteria: weighted sums of Mayer and Lagrange terms over all stages."""

from collections.abc import Iterable

import casadi as ca

from .stage import Stage


def criterion_names(stages: Iterable[Stage]) -> tuple[str, ...]:
    """Names of all criteria in order of appearance: this is the order of the weights theta."""
    names: dict[str, None] = {}
    for stage in stages:
        names |= dict.fromkeys([*stage.mayer, *stage.lagrange])
    return tuple(names)


def mayer_terms(stage: Stage, names: tuple[str, ...]) -> ca.SX:
    """Terms at the end of the stage, zero where a criterion has none, shape (n_criteria, 1)."""
    return ca.vertcat(ca.SX(0, 1), *[stage.mayer.get(name, ca.SX(0)) for name in names])


def lagrange_terms(stage: Stage, names: tuple[str, ...]) -> ca.SX:
    """Integrands over the stage, zero where a criterion has none, shape (n_criteria, 1)."""
    return ca.vertcat(ca.SX(0, 1), *[stage.lagrange.get(name, ca.SX(0)) for name in names])
