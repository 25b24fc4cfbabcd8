"""Issue 3, section 3: least peaks beside published values, adjoint gradients beside differences, time."""

import time
from collections.abc import Callable, Iterator

import numpy as np
from registry import Row, measurement

from gaitlab.benchmarks import one_mass_oscillator, two_axis_robot
from gaitlab.nlp.goal_attainment import GoalAttainment
from gaitlab.nlp.minimax import MinimaxSolution
from gaitlab.nlp.p_norm import PNorm
from gaitlab.ocp.extremal import ExtremalProblem
from gaitlab.transcription.adjoint_simulation import AdjointSimulation

Case = tuple[Callable[[], ExtremalProblem], Callable[[float], float], float, str]
CASES: dict[str, Case] = {
    "one-mass oscillator": (
        one_mass_oscillator.one_mass_oscillator,
        one_mass_oscillator.reaction_force,
        one_mass_oscillator.PUBLISHED_PEAK,
        "N",
    ),
    "two-axis robot": (two_axis_robot.two_axis_robot, two_axis_robot.tool_speed, two_axis_robot.PUBLISHED_PEAK, "m/s"),
}
METHODS = {"goal attainment": GoalAttainment(), "p-norm": PNorm()}
RUNS = 3
FINER = 20
STEP = 1e-6


@measurement(issue=3, line=1)
def minimax_optima() -> Iterator[Row]:
    for subject, (make, physical, published, unit) in CASES.items():
        simulation = AdjointSimulation(problem=make())
        start = np.zeros(simulation.lbw.shape)
        solution = GoalAttainment().solve(simulation, start)
        yield from _certificate(solution, subject)
        peak = physical(solution.value)
        yield Row(quantity="peak", value=peak, limit="", unit=unit, subject=subject)
        yield Row(
            quantity="beside the source", value=abs(peak - published), limit="<= 5e-4", unit=unit, subject=subject
        )
        finer = GoalAttainment().solve(AdjointSimulation(problem=make(), steps_per_node=FINER), start)
        difference = abs(physical(finer.value) - peak) / peak
        yield Row(quantity="beside a finer grid", value=difference, limit="<= 1e-5", unit="", subject=subject)
        smooth = PNorm().solve(simulation, start)
        yield Row(quantity="peak, p-norm", value=physical(smooth.value), limit="", unit=unit, subject=subject)


@measurement(issue=3, line=1)
def minimax_seconds() -> Iterator[Row]:
    for subject, (make, *_) in CASES.items():
        for name, method in METHODS.items():
            simulation = AdjointSimulation(problem=make())
            start = np.zeros(simulation.lbw.shape)
            wall, processor = [], []
            for _ in range(RUNS):
                began, worked = time.perf_counter(), time.process_time()
                solution = method.solve(simulation, start)
                wall.append(time.perf_counter() - began)
                processor.append(time.process_time() - worked)
            limit = "<= 1" if name == "goal attainment" else ""
            # One thread: the processor time is the wall time of an idle machine.
            yield Row(quantity=f"processor time, {name}", value=min(processor), limit=limit, unit="s", subject=subject)
            yield Row(quantity=f"best wall time, {name}", value=min(wall), limit="", unit="s", subject=subject)
            yield Row(quantity=f"iterations, {name}", value=solution.iterations, limit="", unit="", subject=subject)


@measurement(issue=3, line=6)
def adjoint_gradients_of_extremal_values() -> Iterator[Row]:
    for subject, (make, *_) in CASES.items():
        simulation = AdjointSimulation(problem=make())
        w = np.random.default_rng(0).uniform(-1.0, 1.0, simulation.lbw.shape)
        point = simulation.evaluate(w)
        for what, ours in (("values", point.gradients), ("equality", point.equality_jacobian)):
            ahead, behind = (
                [getattr(simulation.evaluate(w + s * e), what) for e in np.eye(len(w))] for s in (STEP, -STEP)
            )
            differences = (np.array(ahead) - np.array(behind)).T / (2.0 * STEP)
            error = float(np.max(np.abs(ours - differences)) / np.max(np.abs(differences)))
            name = "final constraints" if what == "equality" else "extremal values"
            yield Row(quantity=f"gradients of {name}", value=error, limit="<= 1e-6", unit="", subject=subject)


def _certificate(solution: MinimaxSolution, subject: str) -> Iterator[Row]:
    yield Row(
        quantity="first-order residual", value=solution.residuals.max(), limit="<= 1e-6", unit="", subject=subject
    )
    curvature = solution.reduced_curvature
    yield Row(quantity="smallest reduced curvature", value=curvature, limit=">= 0", unit="", subject=subject)
    yield Row(quantity="equal maxima", value=solution.n_largest, limit="", unit="", subject=subject)
    yield Row(quantity="iterations", value=solution.iterations, limit="", unit="", subject=subject)
