import csv
import io

import pytest

from gaitlab.benchmarks.ocp_collection import benchmark
from gaitlab.errors import NotFound
from gaitlab.pipelines.benchmark_tables import (
    FORWARD_COLUMNS,
    INVERSE_COLUMNS,
    as_csv,
    forward_rows,
    inverse_rows,
    published_rows,
)
from gaitlab.pipelines.inverse_methods import METHODS
from gaitlab.pipelines.ocp_benchmark import compare
from gaitlab.report.benchmark_figure import arm_postures, path_in_plane, time_courses

FAST = next(iter(METHODS))


@pytest.fixture(scope="module")
def comparison():
    return compare(benchmark("reeds-shepp-controls"), [FAST])


def test_the_optimum_is_confirmed_and_the_weights_are_found(comparison):
    assert comparison.forward.confirmed
    result = comparison.inverses[0].result
    assert result.is_certified(1e-6)
    # Three standard deviations of the estimates under this noise.
    assert result.p[:2] == pytest.approx([1 / 3, 1 / 3], abs=0.02)


def test_the_estimate_fits_better_than_the_truth(comparison):
    noise = 0.0
    stage = comparison.forward.result.trajectory.stages[0]
    for measured, exact in zip(comparison.measurements, (stage.x, stage.u[:-1]), strict=True):
        noise += 0.5 * float((((exact - measured.values) / measured.sd) ** 2).sum())
    assert comparison.inverses[0].result.objective < noise


def test_tables_have_a_cell_for_every_column(comparison):
    forward, inverse = forward_rows([comparison]), inverse_rows([comparison]) + published_rows([comparison])
    assert {len(row) for row in forward} == {len(FORWARD_COLUMNS)}
    assert {len(row) for row in inverse} == {len(INVERSE_COLUMNS)}
    read = list(csv.DictReader(io.StringIO(as_csv(INVERSE_COLUMNS, inverse))))
    assert read[0]["method"] == FAST and read[1]["iterations"] == "123"


def test_figures_are_the_same_bytes_again(comparison):
    problem, course = comparison.forward.benchmark.problem, comparison.forward.course
    estimates = {FAST: comparison.inverses[0].course}
    figures = [time_courses(problem, course, estimates, comparison.measurements) for _ in range(2)]
    same = figures[0] == figures[1]
    assert same
    assert all(name in figures[0] for name in ("x_2", "u_1", FAST))
    assert path_in_plane(course, estimates, "way").startswith("<?xml")


def test_the_robots_arm_is_drawn_at_every_node():
    chosen = benchmark("polar-robot")
    transcribed = chosen.transcribe()
    w = transcribed.start(chosen.start)
    assert arm_postures(transcribed.trajectory(w, chosen.truth), "arm").count("1.00 s") == 1


def test_unknown_methods_are_refused():
    with pytest.raises(NotFound, match="method 'guess' does not exist"):
        compare(benchmark("rocket-car"), ["guess"])
