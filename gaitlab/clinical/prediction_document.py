"""The part of `result.json` that a prediction adds."""

import msgspec


class PathStep(msgspec.Struct, frozen=True, kw_only=True):
    """One certified solution on the way from the identified gait to the predicted one."""

    share: float
    """Of the change that was asked for, 0 to 1."""
    speed_m_per_s: float
    step_length_m: float
    cadence_steps_per_min: float
    kkt_residual: float
    """Largest violation of the first-order conditions, recomputed, with periodicity and stride time."""
    reduced_hessian: str
    iterations: int
    jump: bool
    """True where the optimum that was followed had ended and another one was found near it."""


class PredictionEntry(msgspec.Struct, frozen=True, kw_only=True):
    """What was asked, how it was reached, and what it changes."""

    source: str
    """Name of the trial whose identified gait was changed."""
    request: dict[str, float]
    """Quantities and the values asked for, in the units of `units`."""
    units: dict[str, str]
    reached: dict[str, float]
    """The same quantities where the path ended."""
    status: str
    """solved, or not_converged: then the path ends before what was asked for."""
    message: str
    path: list[PathStep]
    habit: float
    """Weight [1/rad^2] that holds the identified posture."""
    identified: dict[str, float]
    """Speed, step length, cadence and peak joint torques of the identified gait."""
    predicted: dict[str, float]
    """The same of the predicted one."""
    seconds: float
    assumptions: list[str]
    """What is taken for granted, sentences."""
