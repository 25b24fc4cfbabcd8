import casadi as ca
import numpy as np
import pytest
from chain_problems import everything
from finite_differences import jacobian_by_differences

from gaitlab.errors import ProblemError
from gaitlab.nlp.derivatives import differentiate
from gaitlab.ocp.constraint import Constraint, PointConstraint
from gaitlab.ocp.measurement import Measurement
from gaitlab.transcription.assembly import Assembly, Piece
from gaitlab.transcription.collocation import DirectCollocation
from gaitlab.transcription.control_shapes import CUBIC, LINEAR
from gaitlab.transcription.integrators import RadauIIA, RungeKutta4
from gaitlab.transcription.multiple_shooting import MultipleShooting

METHODS = {
    "shooting": MultipleShooting(grids=(3, 2), integrator=RungeKutta4(n_steps=2)),
    "implicit": MultipleShooting(grids=(2, 2), integrator=RadauIIA(), control=LINEAR),
    "radau": DirectCollocation(grids=(3, 2), degree=2, n_elements=2, control=CUBIC),
    "legendre": DirectCollocation(grids=(3, 2), points="legendre", control=LINEAR),
}


def with_points_and_fit(method):
    problem = everything()
    first, between, last = problem.point(0.0), problem.point(0.37), problem.point(1.0, stage=1)
    coupling = first.x[0] * last.x[0] + between.x[1] * between.u + problem.q[0] ** 2
    problem = problem.with_points(
        PointConstraint(
            points=(first, between, last),
            constraint=Constraint(name="loop", expression=coupling, lower=np.zeros(1), upper=np.ones(1)),
        )
    )
    stage = problem.stages[0]
    fit = Measurement(
        name="fit", function=ca.vertcat(stage.x[0] * stage.u, stage.x[1] + problem.p[0]),
        times=np.array([0.0, 0.4, 1.0]), values=np.ones((3, 2)), sd=np.full((3, 2), 0.5),
    )  # fmt: skip
    return method.transcribe(problem, fit=(fit,))


@pytest.fixture(params=METHODS)
def transcribed(request):
    return with_points_and_fit(METHODS[request.param])


@pytest.fixture
def point(transcribed):
    random = np.random.default_rng(3)
    nlp = transcribed.nlp
    return (
        random.uniform(0.2, 0.8, nlp.w.numel()),
        random.uniform(0.5, 1.0, nlp.p.numel()),
        random.normal(size=nlp.g.numel()),
    )


def test_first_derivatives_match_differences(transcribed, point):
    nlp, (w, p, _) = transcribed.nlp, point
    values = ca.Function("values", [nlp.w, nlp.p], [ca.vertcat(nlp.f, nlp.g)])
    expected = jacobian_by_differences(lambda at: values(at, p), w)
    np.testing.assert_allclose(nlp.derivatives.gradient(w, p)[1].full().ravel(), expected[0], atol=1e-7)
    np.testing.assert_allclose(nlp.derivatives.jacobian(w, p)[1].full(), expected[1:], atol=1e-7)


def test_second_derivatives_match_differences(transcribed, point):
    derivatives, (w, p, lam) = transcribed.nlp.derivatives, point

    def slope(at, parameters):
        return derivatives.gradient(at, parameters)[1] * 0.7 + derivatives.jacobian(at, parameters)[1].T @ lam

    expected = jacobian_by_differences(lambda at: slope(at, p), w)
    np.testing.assert_allclose(derivatives.hessian(w, p, 0.7, lam).full(), np.triu(expected), atol=1e-6)
    mixed, _ = derivatives.mixed(w, p, 0.7, lam)
    np.testing.assert_allclose(mixed.full(), jacobian_by_differences(lambda at: slope(w, at), p), atol=1e-6)


def test_constraints_depend_on_parameters_as_differences_say(transcribed, point):
    derivatives, (w, p, lam) = transcribed.nlp.derivatives, point
    expected = jacobian_by_differences(lambda at: derivatives.jacobian(w, at)[0], p)
    np.testing.assert_allclose(derivatives.mixed(w, p, 1.0, lam)[1].full(), expected, atol=1e-7)


def test_pieces_agree_with_differentiating_the_whole():
    nlp = with_points_and_fit(METHODS["legendre"]).nlp
    w, p, lam = (np.linspace(0.3, 0.9, n) for n in (nlp.w.numel(), nlp.p.numel(), nlp.g.numel()))
    whole = differentiate(nlp.w, nlp.p, nlp.f, nlp.g)
    np.testing.assert_allclose(
        nlp.derivatives.hessian(w, p, 1.0, lam).full(), whole.hessian(w, p, 1.0, lam).full(), atol=1e-10
    )
    assert nlp.derivatives.hessian.sparsity_out(0).nnz() < 0.5 * nlp.w.numel() ** 2


def test_every_constraint_and_unknown_has_a_name(transcribed):
    assert len(transcribed.constraint_names) == transcribed.nlp.g.numel()
    assert len(transcribed.variable_names) == transcribed.nlp.w.numel()


def test_compiled_derivatives_are_the_same(monkeypatch, tmp_path):
    monkeypatch.setenv("GAITLAB_CACHE", str(tmp_path))
    nlp = DirectCollocation(grids=(2, 2), degree=1).transcribe(everything()).nlp
    derivatives, w, p, lam = nlp.derivatives, *(np.full(n, 0.4) for n in (nlp.w.numel(), nlp.p.numel(), nlp.g.numel()))
    np.testing.assert_allclose(
        derivatives.compiled().hessian(w, p, 1.0, lam).full(), derivatives.hessian(w, p, 1.0, lam).full(), atol=1e-12
    )


def test_a_piece_of_wrong_shape_is_refused():
    z = ca.SX.sym("z", 2)
    function = ca.Function("piece", [z, ca.SX.sym("d", 0), ca.SX.sym("p", 0)], [z[0], z])
    with pytest.raises(ProblemError, match="piece piece: unknowns, data and bounds"):
        Piece(function=function, unknowns=np.zeros((1, 3), int), data=np.zeros((1, 0)), lower=np.zeros((1, 2)),
              upper=np.zeros((1, 2)), labels=("a", "b"))  # fmt: skip


def test_entries_of_overlapping_pieces_add_up():
    z = ca.SX.sym("z", 2)
    function = ca.Function("square", [z, ca.SX.sym("d", 1), ca.SX.sym("p", 0)], [z[0] * z[1], ca.SX(0, 1)])
    none = np.zeros((2, 0))
    piece = Piece(
        function=function, unknowns=np.array([[0, 1], [1, 0]]), data=np.zeros((2, 1)), lower=none, upper=none, labels=()
    )
    assembly = Assembly(w=ca.SX.sym("w", 2), p=ca.SX.sym("p", 0), pieces=(piece,))
    hessian = assembly.derivatives().hessian(np.ones(2), np.zeros(0), 1.0, np.zeros(0))
    np.testing.assert_allclose(hessian.full(), [[0.0, 2.0], [0.0, 0.0]])
