"""Examples 4.1 to 4.4 of Sovukluk and Ott (2025)."""

import pytest

from gaitlab.benchmarks.black_box_examples import black_box_examples
from gaitlab.nlp.null_space.method import NullSpaceProjection


@pytest.mark.parametrize("example", black_box_examples(), ids=lambda example: example.name)
def test_published_optimum(example):
    solution = NullSpaceProjection().solve(example.problem, example.x0)
    assert solution.solved
    assert solution.violation < 1e-3
    assert example.error(solution.x) < 1e-3
