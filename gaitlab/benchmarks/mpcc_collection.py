"""Runs every problem of a folder with every method, each in a child process with limits of time and memory."""

import csv
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import OutputError, ProblemError
from ..nlp.child_process import ChildFailure, ChildProcess
from ..nlp.complementarity.multi_start import best
from ..nlp.mpcc_solution import MPCCSolution
from .mpcc_run import RunRequest, RunSetup, StartResult, suffix

CHILD = "gaitlab.benchmarks.mpcc_child"


@dataclass(frozen=True, kw_only=True)
class Row:
    """One method on one problem. Iterations and seconds are sums over the starts."""

    problem: str
    method: str
    status: str
    objective: float
    """As the file states it: maxima are not negated."""
    violation: float
    complementarity: float
    iterations: int
    seconds: float
    sense: int
    """1 where the file minimises, -1 where it maximises; not a column of the CSV file."""

    @property
    def solved(self) -> bool:
        """Whether the point is feasible and certified stationary."""
        return self.status == "solved"

    def reaches(self, best: float) -> bool:
        """Whether the row is solved with an objective as good as `best`, to 1e-3 max(1, |best|)."""
        return self.solved and self.sense * (self.objective - best) <= 1e-3 * max(1.0, abs(best))


COLUMNS = ("problem", "method", "status", "objective", "violation", "complementarity", "iterations", "seconds")


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What one method may take on one problem, all starts together."""

    seconds: float = 60.0
    memory: int = 4_000_000_000
    """Address space [bytes]."""


def problem_files(folder: Path) -> list[Path]:
    """Files of a folder that hold problems, by name.

    Raises:
        ProblemError: The folder does not exist or holds none.
    """
    files = sorted(path for path in folder.iterdir() if suffix(path)) if folder.is_dir() else []
    if not files:
        raise ProblemError(f"{folder}: no problems here; expected .nl, .json or .json.gz files")
    return files


def run_collection(folder: Path, methods: Sequence[str], n_starts: int, limits: Limits) -> Iterator[Row]:
    """Rows in the order of files and methods, as they come. Each file has a child of its own."""
    for path in problem_files(folder):
        child = ChildProcess(CHILD, RunSetup(path=path, n_starts=n_starts), memory=limits.memory)
        try:
            for name in methods:
                yield _run(child, path, name, (n_starts, limits.seconds))
        finally:
            child.close()


def _run(child: ChildProcess, path: Path, method: str, effort: tuple[int, float]) -> Row:
    """Best of the starts of one method. What a crash or the limit leaves out shows in the status."""
    n_starts, seconds = effort
    deadline = time.monotonic() + seconds
    results: list[StartResult] = []
    trouble: list[str] = []
    for start in range(n_starts):
        request = RunRequest(method=method, start=start)
        answer: StartResult | ChildFailure = child.ask(request, deadline - time.monotonic())
        if isinstance(answer, ChildFailure):
            trouble.append("time limit" if answer.timed_out else answer.reason)
            if answer.timed_out:
                break
            continue
        results.append(answer)
        if answer.solution is None:
            trouble.append(answer.error)
            break
    return _row(path, method, results, trouble)


def write_rows(rows: Iterator[Row], path: Path) -> Iterator[Row]:
    """Pass the rows on and write each to a CSV file as it comes.

    Raises:
        OutputError: The file cannot be written.
    """
    try:
        with path.open("w", newline="") as stream:
            writer = csv.writer(stream)
            writer.writerow(COLUMNS)
            for row in rows:
                values = (getattr(row, column) for column in COLUMNS)
                writer.writerow(f"{value:.10g}" if isinstance(value, float) else value for value in values)
                stream.flush()
                yield row
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from error


def _row(path: Path, method: str, results: list[StartResult], trouble: list[str]) -> Row:
    solutions: list[MPCCSolution] = [result.solution for result in results if result.solution is not None]
    nothing = float("nan")
    chosen = best(solutions) if solutions else None
    status = chosen.outcome.name.lower().replace("_", " ") if chosen else "; ".join(trouble)
    if chosen and trouble and not chosen.is_stationary():
        status += f" ({'; '.join(sorted(set(trouble)))})"
    return Row(
        problem=path.name.removesuffix(suffix(path) or ""),
        method=method,
        status=status,
        objective=chosen.f * results[0].sense if chosen else nothing,
        violation=chosen.violation if chosen else nothing,
        complementarity=chosen.complementarity if chosen else nothing,
        iterations=sum(solution.iterations for solution in solutions),
        seconds=sum(result.seconds for result in results),
        sense=results[0].sense if results else 1,
    )


def read_reference(folder: Path) -> dict[str, float]:
    """Best known objectives of a folder's `reference.csv`, columns problem and best_known; empty without one.

    Raises:
        ProblemError: The file has other columns, or something else than numbers.
    """
    path = folder / "reference.csv"
    if not path.is_file():
        return {}
    try:
        with path.open(newline="") as stream:
            return {line["problem"]: float(line["best_known"]) for line in csv.DictReader(stream)}
    except (KeyError, ValueError, UnicodeDecodeError) as error:
        raise ProblemError(f"{path}: expected columns problem and best_known with numbers ({error})") from error
