"""Weights of several results, ready to be drawn side by side."""

from collections.abc import Mapping
from dataclasses import dataclass

from ..clinical.comparison import Comparison
from ..clinical.document import CriterionWeight


@dataclass(frozen=True, kw_only=True)
class WeightSeries:
    """Weights of one result."""

    label: str
    weights: Mapping[str, CriterionWeight]
    converged: bool


def weight_series(comparison: Comparison) -> tuple[WeightSeries, ...]:
    """Weights of every result that has some, in the order of the tables."""
    return tuple(
        WeightSeries(
            label=member.label,
            weights={criterion.name: criterion for criterion in weights.criteria},
            converged=weights.solver.status == "solved",
        )
        for member in comparison.members
        if (weights := member.document.weights) is not None
    )
