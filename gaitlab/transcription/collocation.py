"""Direct collocation (Biegler 2010, ch. 10)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ..ocp.measurement import Measurement
from ..ocp.problem import MultiStageProblem
from .control_shapes import CONSTANT, ControlShape
from .schemes import Collocation
from .transcribe import Discretisation, Grids, transcribe
from .transcribed import Transcribed


@dataclass(frozen=True, kw_only=True)
class DirectCollocation:
    """States are polynomials whose values at collocation points are unknowns."""

    grids: Grids
    points: Literal["radau", "legendre"] = "radau"
    degree: int = 3
    n_elements: int = 1
    """Polynomials per interval; controls and bounds keep to intervals."""
    control: ControlShape = CONSTANT
    bound_inside: bool = True
    """Whether bounds on states hold at collocation points, not only at nodes."""

    def transcribe(self, problem: MultiStageProblem, fit: Sequence[Measurement] = ()) -> Transcribed:
        """Discretise; measurements to `fit` add their least squares to the objective."""
        scheme = Collocation(degree=self.degree, points=self.points, n_elements=self.n_elements)
        how = Discretisation(grids=self.grids, scheme=scheme, shape=self.control, bound_inside=self.bound_inside)
        return transcribe(problem, how, fit)
