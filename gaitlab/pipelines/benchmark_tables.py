"""What the optimal control benchmarks gave, as tables of text and as CSV."""

import csv
import io
from collections.abc import Sequence

from .ocp_benchmark import Comparison, Forward, Inverse

FORWARD_COLUMNS = (
    "problem", "published objective", "our objective", "published duration", "our duration", "finer objective",
    "relative difference", "status", "iterations", "seconds", "remark",
)  # fmt: skip
INVERSE_COLUMNS = (
    "problem", "method", "status", "objective", "estimates", "truth", "lower residual", "iterations",
    "lower iterations", "cold s", "warm s", "thesis s", "times thesis", "times fastest", "reason",
)  # fmt: skip
PRINTED_FORWARD = ("problem", "published objective", "our objective", "published duration", "our duration",
                   "relative difference", "iterations", "seconds")  # fmt: skip
PRINTED_INVERSE = ("problem", "method", "status", "objective", "estimates", "iterations", "warm s", "thesis s",
                   "times thesis", "times fastest")  # fmt: skip
"""The columns that fit on a screen; files have all."""
UNKNOWN = "-"


def chosen(columns: Sequence[str], rows: Sequence[Sequence[str]], wanted: Sequence[str]) -> list[tuple[str, ...]]:
    """The wanted columns of rows."""
    places = [columns.index(name) for name in wanted]
    return [tuple(row[i] for i in places) for row in rows]


def forward_rows(comparisons: Sequence[Comparison]) -> list[tuple[str, ...]]:
    """One row per problem under `FORWARD_COLUMNS`."""
    return [_forward_row(comparison.forward) for comparison in comparisons]


def inverse_rows(comparisons: Sequence[Comparison]) -> list[tuple[str, ...]]:
    """One row per problem and method under `INVERSE_COLUMNS`."""
    return [_inverse_row(each, inverse) for each in comparisons for inverse in each.inverses]


def published_rows(comparisons: Sequence[Comparison]) -> list[tuple[str, ...]]:
    """The thesis's inverse results, of its own noise, under `INVERSE_COLUMNS`."""
    return [_published_row(each) for each in comparisons]


def as_csv(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Comma-separated values with a header."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return text.getvalue()


def _forward_row(forward: Forward) -> tuple[str, ...]:
    benchmark, result = forward.benchmark, forward.result
    published = benchmark.published
    objective = UNKNOWN if published.objective is None else f"{published.objective:.5g}"
    status = "certified, confirmed" if forward.confirmed else f"not confirmed: {result.reason}; {forward.finer.reason}"
    return (
        benchmark.name, objective, f"{result.solution.f:.8g}", f"{published.duration:.5g}",
        f"{result.trajectory.duration:.7g}", f"{forward.finer.solution.f:.8g}", f"{forward.difference:.1e}", status,
        str(result.solution.iterations), f"{forward.seconds:.3f}", published.remark,
    )  # fmt: skip


def _inverse_row(comparison: Comparison, inverse: Inverse) -> tuple[str, ...]:
    benchmark, result = comparison.forward.benchmark, inverse.result
    names = benchmark.unknowns.names
    places = [benchmark.problem.parameter_index(name) for name in names]
    estimates = ", ".join(f"{name} {result.p[i]:.5g}" for name, i in zip(names, places, strict=True))
    truth = ", ".join(f"{benchmark.truth[i]:.5g}" for i in places)
    thesis = benchmark.published_estimate.seconds_of(inverse.method)
    fastest = min(each.warm_seconds for each in comparison.inverses)
    return (
        benchmark.name, inverse.method, str(result.status), f"{result.objective:.8g}", estimates, truth,
        f"{result.residuals.max():.1e}", str(result.iterations), str(result.lower_iterations),
        f"{inverse.cold_seconds:.3f}", f"{inverse.warm_seconds:.3f}", UNKNOWN if thesis is None else f"{thesis:.3f}",
        UNKNOWN if thesis is None else f"{inverse.warm_seconds / thesis:.4f}",
        f"{inverse.warm_seconds / fastest:.1f}", result.reason,
    )  # fmt: skip


def _published_row(comparison: Comparison) -> tuple[str, ...]:
    benchmark = comparison.forward.benchmark
    published = benchmark.published_estimate
    estimates = ", ".join(f"{name} {value:.5g}" for name, value in published.estimates.items())
    seconds = UNKNOWN if published.seconds is None else f"{published.seconds:.3f}"
    return (
        benchmark.name, "thesis, all-at-once", "published", f"{published.objective:.5g}", estimates, "", UNKNOWN,
        str(published.iterations), UNKNOWN, UNKNOWN, UNKNOWN, seconds, UNKNOWN, UNKNOWN, published.remark,
    )  # fmt: skip
