"""The weights in words: sentences made from the numbers and from nothing else."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from .result import Criterion, Result, Weights, mapping, real

CAVEAT = (
    "A weight is a share of a model's cost, not a cause: it says which mix of criteria makes this model walk most "
    "like this recording, with this choice of criteria and this model of the body. It does not say what the person "
    "intends, and it does not explain an impairment."
)


def spoken(name: str) -> str:
    """Name of a criterion in words: `torque_squared` is spoken `torque squared`."""
    return name.replace("_", " ").strip() or name


def _percent(value: float) -> str:
    return f"{100.0 * value:.0f} %"


def _share(criterion: Criterion, reference: Mapping[str, tuple[float, float]]) -> str:
    """One criterion with its standard deviation and, where there is one, the cohort's mean +- 1 SD."""
    words = f"{spoken(criterion.name)} {_percent(criterion.weight or 0.0)}"
    notes = [f"sd {_percent(criterion.sd)}"] if criterion.sd is not None else []
    if criterion.name in reference:
        mean, sd = reference[criterion.name]
        low, high = max(mean - sd, 0.0), min(mean + sd, 1.0)
        notes.append(f"reference cohort {100.0 * low:.0f}-{_percent(high)}")
    return words + (f" ({'; '.join(notes)})" if notes else "")


def cohort_weights(result: Result) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation of the reference cohort's weights, if it has the same criteria as this result."""
    reference = mapping(result.part("scores").get("reference"))
    stored = {name: mapping(value) for name, value in mapping(reference.get("weights")).items()}
    pairs = {name: (real(value.get("mean")), real(value.get("sd"))) for name, value in stored.items()}
    found = {name: (mean, sd) for name, (mean, sd) in pairs.items() if mean is not None and sd is not None}
    criteria = set[str]() if result.weights is None else {criterion.name for criterion in result.weights.criteria}
    return found if set(found) == criteria else {}


def _ranked(weights: Weights) -> list[tuple[int, Criterion]]:
    usable = [(i, c) for i, c in enumerate(weights.criteria) if c.identifiable and c.weight is not None]
    return sorted(usable, key=lambda item: -(item[1].weight or 0.0))


def _sd_of_difference(weights: Weights, i: int, j: int) -> float | None:
    r"""Standard deviation of the difference of two weights, s^2 = s_i^2 + s_j^2 - 2 r_ij s_i s_j."""
    s_i, s_j = weights.criteria[i].sd, weights.criteria[j].sd
    if s_i is None or s_j is None:
        return None
    r_ij = 0.0 if weights.correlation is None else float(np.nan_to_num(weights.correlation[i, j]))
    return float(np.sqrt(max(s_i**2 + s_j**2 - 2.0 * r_ij * s_i * s_j, 0.0)))


def _order(weights: Weights) -> list[str]:
    sentences = list[str]()
    for (i, larger), (j, smaller) in pairwise(_ranked(weights)[:3]):
        sd = _sd_of_difference(weights, i, j)
        difference = (larger.weight or 0.0) - (smaller.weight or 0.0)
        names = f"{spoken(larger.name)} and {spoken(smaller.name)}"
        if sd is None:
            sentences.append(f"The order of {names} is not assessed: the document gives no standard deviation.")
        elif difference > 2.0 * sd:
            sentences.append(
                f"{names} differ by {_percent(difference)}, more than two standard deviations ({_percent(sd)})."
            )
        else:
            sentences.append(
                f"{names} differ by {_percent(difference)}, within two standard deviations ({_percent(sd)}): which of "
                "the two is larger is not established by this recording."
            )
    return [sentence[:1].upper() + sentence[1:] for sentence in sentences]


def _unidentifiable(weights: Weights) -> list[str]:
    names = [spoken(criterion.name) for criterion in weights.criteria if not criterion.identifiable]
    if not names:
        return []
    return [
        f"Not identifiable from this recording: {', '.join(names)}. Such a weight can change without changing the "
        "model's walk noticeably; its value (hatched) is not to be read."
    ]


def _at_bound(weights: Weights) -> list[str]:
    names = [spoken(criterion.name) for criterion in weights.criteria if criterion.at_bound]
    if not names:
        return []
    return [f"Zero because a weight cannot be negative: {', '.join(names)}. The model fits best without it."]


def _fit(weights: Weights) -> list[str]:
    if weights.fit_rms is None:
        return []
    sentence = f"With these weights the model differs from the measured walk by {_angle(weights.fit_rms)} rms"
    if not weights.comparison:
        return [sentence + "."]
    others = sorted(weights.comparison.items(), key=lambda item: item[1])
    listed = ", ".join(f"{spoken(name)} {_angle(rms)}" for name, rms in others)
    worse = [spoken(name) for name, rms in others if rms <= weights.fit_rms]
    sentences = [f"{sentence}; for comparison: {listed}."]
    if worse:
        sentences.append(f"These weights are no better than: {', '.join(worse)}.")
    return sentences


def _angle(rms: float) -> str:
    return f"{np.degrees(rms):.1f} deg ({rms:.3f} rad)"


def weights_in_words(weights: Weights, reference: Mapping[str, tuple[float, float]] | None = None) -> list[str]:
    """Sentences on shares, order, identifiability and fit, or on why there are none; the caveat stands apart.

    Args:
        weights: Of one result.
        reference: Mean and standard deviation of a reference cohort's weights by criterion, as `cohort_weights` says.
    """
    if not weights.converged:
        state = spoken(weights.status or "not stated")
        return [
            f"The computation did not reach its certificate (status: {state}). The numbers below are the last iterate; "
            "they are not a result, and nothing is concluded from them."
        ]
    sentences = list[str]()
    ranked = [criterion for _, criterion in _ranked(weights)]
    if ranked:
        shares = ", ".join(_share(criterion, reference or {}) for criterion in ranked)
        sentences.append(f"Shares of the modelled cost: {shares}.")
    if not reference:
        sentences.append("No reference cohort for weights: none with these criteria applies.")
    return sentences + _order(weights) + _at_bound(weights) + _unidentifiable(weights) + _fit(weights)
