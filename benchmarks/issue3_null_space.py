"""Issue 3, section 5: the black-box optimiser on its published examples and on a posture, beside SLSQP."""

import time
from collections.abc import Iterator

import numpy as np
from registry import CHILDREN, Row, measurement
from scipy.optimize import minimize
from vicon import recording
from walking_body import walking_coordinates

from gaitlab.benchmarks.black_box_examples import black_box_examples
from gaitlab.inverse.conventional import joint_kinematics
from gaitlab.inverse.static import calibrate_subject
from gaitlab.multibody.presets import thesis_able_bodied_child, thesis_cp_child
from gaitlab.multibody.scaling import SubjectSettings
from gaitlab.nlp.null_space.method import NullSpaceProjection
from gaitlab.pipelines.model import person_model, whole_model_motion
from gaitlab.walking.posture import PostureProblem, least_load_posture

INDEPENDENT = [0, 1, 2, 4, 5, 6, 7, 8, 10, 11, 12, 13]
"""Rows of a posture's equalities without those that rigid feet imply."""


@measurement(issue=3, line=2)
def black_box_examples_beside_the_source() -> Iterator[Row]:
    for example in black_box_examples():
        solution = NullSpaceProjection().solve(example.problem, example.x0)
        error, published = example.error(solution.x), example.published_iterations
        yield Row(quantity="distance from the optimum", value=error, limit="<= 1e-3", unit="", subject=example.name)
        yield Row(quantity="violation", value=solution.violation, limit="<= 1e-3", unit="", subject=example.name)
        yield Row(quantity="iterations", value=solution.iterations, limit="", unit="", subject=example.name)
        yield Row(quantity="iterations of the source", value=published, limit="", unit="", subject=example.name)
        yield Row(quantity="time", value=solution.seconds, limit="", unit="s", subject=example.name)


@measurement(issue=3, line=2)
def least_load_postures_beside_slsqp() -> Iterator[Row]:
    for make in (thesis_able_bodied_child, thesis_cp_child):
        child = make()
        problem = PostureProblem(subject=child, measured=walking_coordinates(child)[10])
        ours = least_load_posture(problem)
        yield from _rows("null space", ours.cost, ours.violation, ours.seconds, ours.iterations, child.name)
        yield Row(quantity="solved, null space", value=float(ours.solved), limit=">= 1", unit="", subject=child.name)
        for name, rows in (("SLSQP, independent rows", INDEPENDENT), ("SLSQP, all rows", slice(None))):
            yield from _slsqp(problem, rows, name, child.name)
        start = problem.cost(problem.measured)
        yield Row(quantity="cost, measured posture", value=start, limit="", unit="", subject=child.name)


@measurement(issue=3, line=2)
def least_load_postures_of_children() -> Iterator[Row]:
    """Standing children: feet where the static trial has them."""
    for child in CHILDREN[:3]:
        static, walk = (recording(f"children/{child}/{kind}_*.c3d") for kind in ("static", "straight"))
        calibration = calibrate_subject(static, walk, {})
        kinematics = joint_kinematics(static, calibration)
        subject = person_model(static, kinematics, calibration.parameters, SubjectSettings())
        q = whole_model_motion(subject, static, kinematics).q
        problem = PostureProblem(subject=subject, measured=q[np.all(np.isfinite(q), axis=1)][0])
        ours = least_load_posture(problem)
        yield from _rows("null space", ours.cost, ours.violation, ours.seconds, ours.iterations, child)
        yield Row(quantity="solved, null space", value=float(ours.solved), limit=">= 1", unit="", subject=child)
        yield from _slsqp(problem, INDEPENDENT, "SLSQP, independent rows", child)
        start = problem.cost(problem.measured)
        yield Row(quantity="cost, measured posture", value=start, limit="", unit="", subject=child)


def _slsqp(problem: PostureProblem, rows: list[int] | slice, name: str, subject: str) -> Iterator[Row]:
    constraints = (
        {"type": "eq", "fun": lambda q: problem.equality(q)[rows]},
        {"type": "ineq", "fun": lambda q: -problem.inequality(q)},
    )
    began = time.perf_counter()
    result = minimize(problem.cost, problem.measured, method="SLSQP", constraints=constraints)
    seconds = time.perf_counter() - began
    violation = max(float(np.abs(problem.equality(result.x)).max()), float(problem.inequality(result.x).max()))
    yield from _rows(name, float(result.fun), violation, seconds, int(result.nit), subject)
    yield Row(quantity=f"success, {name}", value=float(result.success), limit="", unit="", subject=subject)


def _rows(name: str, cost: float, violation: float, seconds: float, iterations: int, subject: str) -> Iterator[Row]:
    yield Row(quantity=f"cost, {name}", value=cost, limit="", unit="", subject=subject)
    yield Row(quantity=f"violation, {name}", value=violation, limit="", unit="", subject=subject)
    yield Row(quantity=f"time, {name}", value=seconds, limit="", unit="s", subject=subject)
    yield Row(quantity=f"iterations, {name}", value=iterations, limit="", unit="", subject=subject)
