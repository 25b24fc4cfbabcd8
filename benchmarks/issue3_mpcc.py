"""Issue 3, line 5: the MPCC collection, and filterSQP's iterations lifted and unlifted beside Hatz (2014)."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from registry import ROOT, Row, measurement

from gaitlab.benchmarks.mpcc_collection import Limits, problem_files, read_reference, run_collection
from gaitlab.benchmarks.mpcc_methods import METHODS
from gaitlab.benchmarks.mpcc_run import read
from gaitlab.nlp.complementarity.lifting import LiftingL1, LiftingL2
from gaitlab.nlp.complementarity.method import Schedule
from gaitlab.nlp.complementarity.treatment import Treatment
from gaitlab.nlp.complementarity.unlifted import Unlifted
from gaitlab.nlp.uno import Uno

COLLECTION = ROOT.parent / "shared" / "mpcc"

# Hatz (2014), Tables 13.1 and 13.2: iterations and penalty parameter l1-lifted, the same l2-lifted, iterations
# unlifted, None where filterSQP reports infeasibility. Only problems that the shared folder has.
PUBLISHED = {
    "bard1m": (3, 3, 3, 1.5e4, 3), "bard2m": (3, 2, 3, 1e4, 3), "bard3m": (4, 2, 4, 1e4, 4),
    "desilva": (2, 1, 2, 1, 2), "hs044-i": (4, 1, 4, 1e5, 4), "sl1": (1, 1, 1, 1, 1), "bard1": (3, 3, 3, 1e5, 3),
    "bard2": (1, 1, 1, 1e6, 1), "bard3": (2, 1, 2, 1e4, 4), "bilevel1": (3, 3, 3, 1e5, 4),
    "bilevel2": (2, 1, 2, 1e6, 6), "bilevel3": (6, 5, 5, 1e5, 7), "ex9.1.1": (1, 1, 1, 1, 1),
    "ex9.1.3": (2, 20, 2, 1e5, 2), "ex9.1.4": (1, 1, 2, 1e4, 4), "ex9.1.5": (3, 1, 2, 1, 3),
    "ex9.1.6": (2, 3, 2, 1e5, 2), "ex9.1.7": (5, 15, 6, 1e5, 3), "ex9.1.8": (2, 1, 2, 1e4, 2),
    "ex9.1.9": (2, 2, 2, 1e4, 2), "ex9.1.10": (1, 1, 2, 1e4, 2), "ex9.2.1": (1, 1, 1, 1e5, 1),
    "ex9.2.2": (22, 7, 9, 1e5, 22), "ex9.2.4": (3, 1, 3, 1, 3), "ex9.2.5": (3, 10, 3, 1, 7),
    "ex9.2.6": (3, 1, 3, 1, 3), "ex9.2.7": (2, 10, 2, 1e5, 2), "ex9.2.8": (3, 1, 3, 1, 3),
    "hatz_8_31": (8, 1, 7, 1e3, 12), "ex9.2.3": (3, 1, 3, 1e5, None), "ex9.2.9": (1, 1, 1, 1, None),
    "bilin": (3, 8, 4, 1e4, None), "dempe": (39, 1, 8, 1e5, 58), "df1": (2, 1, 2, 1, 2), "flp2": (1, 1, 1, 1, 1),
    "hakonsen": (10, 1, 10, 1e4, 10), "monteiro": (8, 1000, 10, 1e6, 9), "monteiroB": (8, 1000, 10, 1e6, 9),
    "outrata31": (7, 3, 7, 1e4, 8), "outrata32": (7, 2, 7, 1e4, 8), "outrata33": (6, 2, 6, 1e4, 7),
    "outrata34": (6, 1, 6, 1e4, 6), "scholtes1": (3, 1, 3, 1e4, 4), "scholtes2": (2, 4, 2, 1e7, 15),
    "stackelberg1": (4, 1, 4, 1e6, 4), "gauvin": (3, 7, 3, 1e4, None), "scholtes4": (19, 1, 18, 1e4, None),
}  # fmt: skip


@measurement(issue=3, line=5)
def collection_with_five_starts() -> Iterator[Row]:
    """Problems of the shared folder whose best known objective is reached, by method."""
    reference, reached = read_reference(COLLECTION), dict.fromkeys(METHODS, 0)
    for row in run_collection(COLLECTION, METHODS, 5, Limits()):
        best = reference.get(row.problem)
        if best is not None:
            close = abs(row.objective - best) <= 1e-3 * max(1.0, abs(best))
            reached[row.method] += close and row.violation <= 1e-6 and row.complementarity <= 1e-5
    for name, count in reached.items():
        yield Row(quantity="reached of 60", value=count, limit="", unit="", subject=name)
    yield Row(quantity="reached by the best method", value=max(reached.values()), limit=">= 58", unit="", subject="all")


@measurement(issue=3, line=5)
def filter_sqp_iterations() -> Iterator[Row]:
    """One subproblem from the file's start with the thesis's penalty parameter; sums over problems solved all ways."""
    ours, theirs, ends = np.zeros(3), np.zeros(3), np.zeros(3)
    for path in problem_files(COLLECTION):
        name = path.name.removesuffix(".nl").removesuffix(".json")
        if name not in PUBLISHED:
            continue
        counts = _iterations(path, PUBLISHED[name][1], PUBLISHED[name][3])
        ends += np.isfinite(counts)
        published = [PUBLISHED[name][k] for k in (0, 2, 4)]
        if np.all(np.isfinite(counts)) and None not in published:
            ours += counts
            theirs += np.array(published, dtype=float)
    for k, kind in enumerate(("l1-lifted", "l2-lifted", "unlifted")):
        yield Row(quantity="iterations", value=ours[k], limit="", unit="", subject=kind)
        yield Row(quantity="iterations published, same problems", value=theirs[k], limit="", unit="", subject=kind)
        yield Row(quantity=f"solved of {len(PUBLISHED)}", value=ends[k], limit="", unit="", subject=kind)


def _iterations(path: Path, weight_l1: float, weight_l2: float) -> np.ndarray:
    named, solver = read(path), Uno(isolated=True, seconds=10.0, max_iter=500)
    methods: list[Treatment] = [
        LiftingL1(solver=solver, crossover=False, schedule=Schedule(first=weight_l1, factor=2.0, last=weight_l1)),
        LiftingL2(solver=solver, crossover=False, schedule=Schedule(first=weight_l2, factor=2.0, last=weight_l2)),
        Unlifted(solver=solver, crossover=False),
    ]
    counts = np.full(len(methods), np.nan)
    for k, each in enumerate(methods):
        solution = each.solve(named.problem, named.start)
        # The quadratic penalty leaves v of the order of 1 / pi.
        if solution.is_feasible(1e-3, 1e-3):
            counts[k] = solution.iterations
    return counts
