import numpy as np
import pytest
from chain_problems import doubling_jump, everything, regulator, shortest_time

from gaitlab.errors import ProblemError
from gaitlab.ocp.trajectory import Trajectory, straight_line
from gaitlab.transcription.collocation import DirectCollocation
from gaitlab.transcription.control_shapes import CUBIC, LINEAR
from gaitlab.transcription.grid import Grid, uniform
from gaitlab.transcription.multiple_shooting import MultipleShooting
from gaitlab.transcription.optimal_control import Solve


@pytest.mark.parametrize(
    "method", [MultipleShooting(grids=8, control=LINEAR), DirectCollocation(grids=8, control=CUBIC)]
)
def test_a_solution_read_and_written_again_is_a_solution(method):
    problem, weights = regulator(), np.array([1.0, 1.0])
    transcribed = method.transcribe(problem)
    result = Solve()(transcribed, straight_line(problem, np.zeros(0)), weights)
    again = transcribed.start(transcribed.trajectory(result.solution.w, weights))
    stage = transcribed.layout.stages[0]
    for places in (stage.x, stage.c[:, :1]):
        np.testing.assert_allclose(again[places], result.solution.w[places], atol=1e-12)


def test_samples_between_nodes_obey_the_differential_equation():
    problem, weights = shortest_time(), np.array([1.0])
    for method in (MultipleShooting(grids=5), DirectCollocation(grids=5, points="legendre", n_elements=2)):
        transcribed = method.transcribe(problem)
        result = Solve()(transcribed, straight_line(problem, np.array([1.0])), weights)
        stage = transcribed.trajectory(result.solution.w, weights, per_interval=10).stages[0]
        slopes, middles = np.diff(stage.x[:, 0]) / np.diff(stage.t), 0.5 * (stage.x[1:, 1] + stage.x[:-1, 1])
        # Exact for the parabolas of constant acceleration.
        np.testing.assert_allclose(slopes, middles, atol=1e-6)


def test_stages_may_have_grids_of_their_own():
    problem = doubling_jump()
    coarse_and_uneven = (3, Grid(nodes=np.array([0.0, 0.2, 1.0])))
    transcribed = MultipleShooting(grids=coarse_and_uneven).transcribe(problem)
    result = Solve()(transcribed, straight_line(problem, np.zeros(0)), np.array([1.0]))
    assert [stage.x.shape for stage in result.trajectory.stages] == [(4, 1), (3, 1)]
    assert result.solution.f == pytest.approx(0.2, abs=1e-8)


def test_unknowns_are_ordered_along_time():
    transcribed = MultipleShooting(grids=(4, 3)).transcribe(everything())
    rows, columns = transcribed.nlp.derivatives.jacobian.sparsity_out(1).get_triplet()
    n_q = transcribed.layout.q.size
    reach = [abs(i - j) for i, j in zip(rows, columns, strict=True) if j >= n_q and i < 12]
    assert max(reach) < 12


def test_what_does_not_fit_is_refused():
    problem = doubling_jump()
    with pytest.raises(ProblemError, match="2 stages need as many grids, got 3"):
        MultipleShooting(grids=(1, 2, 3)).transcribe(problem)
    transcribed = MultipleShooting(grids=2).transcribe(problem)
    with pytest.raises(ProblemError, match="the start must have 2 stages, got 0"):
        transcribed.start(Trajectory(stages=()))
    with pytest.raises(ProblemError, match="q of the start"):
        transcribed.start(straight_line(problem, np.ones(2)))
    with pytest.raises(ProblemError, match="must increase from 0 to 1"):
        Grid(nodes=np.array([0.0, 0.5, 0.5, 1.0]))
    with pytest.raises(ProblemError, match="at least one interval"):
        uniform(0)
    with pytest.raises(ProblemError, match="collocation needs 1 to 12 points, got 0"):
        DirectCollocation(grids=2, degree=0).transcribe(problem)
