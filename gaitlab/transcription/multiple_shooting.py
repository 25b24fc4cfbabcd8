"""Direct multiple shooting (Bock and Plitt 1984)."""

from collections.abc import Sequence
from dataclasses import dataclass

from ..ocp.measurement import Measurement
from ..ocp.problem import MultiStageProblem
from .control_shapes import CONSTANT, ControlShape
from .integrators import Integrator, RungeKutta4
from .schemes import Shooting
from .transcribe import Discretisation, Grids, transcribe
from .transcribed import Transcribed


@dataclass(frozen=True, kw_only=True)
class MultipleShooting:
    """States at nodes are unknowns; between nodes they are integrated from the left."""

    grids: Grids
    integrator: Integrator = RungeKutta4(n_steps=4)
    control: ControlShape = CONSTANT

    def transcribe(self, problem: MultiStageProblem, fit: Sequence[Measurement] = ()) -> Transcribed:
        """Discretise; measurements to `fit` add their least squares to the objective."""
        scheme = Shooting(integrator=self.integrator)
        return transcribe(
            problem, Discretisation(grids=self.grids, scheme=scheme, shape=self.control, bound_inside=False), fit
        )
