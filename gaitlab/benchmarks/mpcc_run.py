"""One method on one problem of a collection, start by start."""

import time
from dataclasses import dataclass
from pathlib import Path

from ..errors import ProblemError
from ..nlp.complementarity.method import PreparedMethod
from ..nlp.complementarity.multi_start import starts
from ..nlp.mpcc_solution import MPCCSolution
from .ampl import read_ampl
from .casadi_json import read_casadi_json
from .mpcc_methods import method
from .mpcc_problem import NamedMPCC

READERS = {".nl": read_ampl, ".json": read_casadi_json, ".json.gz": read_casadi_json}


def suffix(path: Path) -> str | None:
    """The ending that says how to read a file; None where nobody can."""
    return next((ending for ending in READERS if path.name.endswith(ending)), None)


def read(path: Path) -> NamedMPCC:
    """Problem of a file.

    Raises:
        ProblemError: The file cannot be read.
    """
    ending = suffix(path)
    if ending is None:
        raise ProblemError(f"{path}: not one of {', '.join(READERS)}")
    return READERS[ending](path)


@dataclass(frozen=True, kw_only=True)
class RunSetup:
    """What a child is told first."""

    path: Path
    n_starts: int


@dataclass(frozen=True, kw_only=True)
class RunRequest:
    """One method from one start."""

    method: str
    start: int


@dataclass(frozen=True, kw_only=True)
class StartResult:
    """Answer for one start."""

    solution: MPCCSolution | None
    """None where the problem cannot be read or posed."""
    error: str
    sense: int
    seconds: float


class ProblemRun:
    """Answers requests for methods and starts."""

    def __init__(self, setup: RunSetup) -> None:
        self._error = ""
        self._prepared: dict[str, PreparedMethod] = {}
        try:
            self._named = read(setup.path)
            self._starts = starts(self._named.problem, self._named.start, setup.n_starts)
        except (ProblemError, RuntimeError) as error:
            self._error = _last_line(error)

    def __call__(self, request: RunRequest) -> StartResult:
        """Solve once."""
        if self._error:
            return StartResult(solution=None, error=self._error, sense=1, seconds=0.0)
        began = time.perf_counter()
        try:
            if request.method not in self._prepared:
                self._prepared[request.method] = method(request.method).prepare(self._named.problem)
            solution, error = self._prepared[request.method].solve(self._starts[request.start]), ""
        except (ProblemError, RuntimeError) as failure:
            solution, error = None, _last_line(failure)
        seconds = time.perf_counter() - began
        return StartResult(solution=solution, error=error, sense=self._named.sense, seconds=seconds)


def _last_line(error: Exception) -> str:
    return (str(error).strip().splitlines() or ["no reason given"])[-1]
