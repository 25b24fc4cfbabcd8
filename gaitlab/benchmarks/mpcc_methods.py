"""Methods for collections of MPCCs: every treatment of complementarity with every solver."""

from collections.abc import Callable

from ..errors import NotFound
from ..nlp.complementarity.lifting import LiftingL1, LiftingL2
from ..nlp.complementarity.method import MPCCMethod
from ..nlp.complementarity.penalty import Penalty
from ..nlp.complementarity.relaxation import Relaxation
from ..nlp.complementarity.treatment import Treatment
from ..nlp.complementarity.unlifted import Unlifted
from ..nlp.ipopt import Ipopt
from ..nlp.solver import NLPSolver
from ..nlp.uno import Uno

TREATMENTS: dict[str, Callable[[NLPSolver], Treatment]] = {
    "unlifted": lambda solver: Unlifted(solver=solver),
    "l1-lifted": lambda solver: LiftingL1(solver=solver),
    "l2-lifted": lambda solver: LiftingL2(solver=solver),
    "penalty": lambda solver: Penalty(solver=solver),
    "relaxation": lambda solver: Relaxation(solver=solver),
}
# The collection runs each problem in a child of its own; a second one around Uno would only cost time.
SOLVERS: dict[str, Callable[[], NLPSolver]] = {
    "filtersqp": lambda: Uno(isolated=False, max_iter=1000),
    "ipopt": lambda: Ipopt(max_iter=1000),
}
METHODS = tuple(f"{treatment}-{solver}" for treatment in TREATMENTS for solver in SOLVERS)


def method(name: str) -> MPCCMethod:
    """Method by its name, `treatment-solver`.

    Raises:
        NotFound: There is no such method; says which there are.
    """
    if name not in METHODS:
        raise NotFound("method", name, METHODS)
    treatment, solver = name.rsplit("-", 1)
    return TREATMENTS[treatment](SOLVERS[solver]())
