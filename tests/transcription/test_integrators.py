import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.transcription.integrators import RadauIIA, RungeKutta4


def error(integrator):
    """Of x(1) = e for dx/ds = x^2 / e^s, x(0) = 1, whose solution is e^s."""
    s, x, width = ca.SX.sym("s"), ca.SX.sym("x"), ca.SX.sym("width")
    step = integrator.integrate(lambda at, value: value**2 / ca.exp(at), s, x, width)
    return abs(float(ca.Function("step", [s, x, width], [step.x])(0.0, 1.0, 1.0)) - np.e)


def quadrature_error(integrator):
    """Of int_0^1 x^2 ds = (e^2 - 1) / 2 along the same solution."""
    step = integrator.integrate(lambda at, value: value**2 / ca.exp(at), ca.SX(0), ca.SX(1), ca.SX(1))
    return abs(float(sum(sample.weight * sample.x**2 for sample in step.samples)) - (np.e**2 - 1) / 2)


@pytest.mark.parametrize("measure", [error, quadrature_error])
@pytest.mark.parametrize(
    ("make", "order", "n"),
    [
        (lambda n: RungeKutta4(n_steps=n), 4, 4),
        (lambda n: RadauIIA(n_steps=n, n_stages=1), 1, 32),
        (lambda n: RadauIIA(n_steps=n, n_stages=2), 3, 4),
        (lambda n: RadauIIA(n_steps=n, n_stages=3), 5, 4),
    ],
    ids=["runge-kutta", "radau-1", "radau-3", "radau-5"],
)
def test_errors_fall_with_the_order(make, order, n, measure):
    assert np.log2(measure(make(n)) / measure(make(2 * n))) == pytest.approx(order, abs=0.35)


def test_the_implicit_method_damps_what_the_explicit_one_blows_up():
    def after_one_step(integrator):
        return abs(float(integrator.integrate(lambda _, x: -1e6 * x, ca.SX(0), ca.SX(1), ca.SX(1)).x))

    assert after_one_step(RadauIIA()) < 1e-4
    assert after_one_step(RungeKutta4()) > 1e20


def test_no_steps_are_refused():
    with pytest.raises(ProblemError, match="at least one step"):
        RungeKutta4(n_steps=0)
