"""The runner, on files made here; the shared collection in the slow test."""

import csv
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from gaitlab.benchmarks import mpcc_collection
from gaitlab.benchmarks.mpcc_collection import Limits, Row, problem_files, read_reference, run_collection, write_rows
from gaitlab.benchmarks.mpcc_methods import METHODS, method
from gaitlab.benchmarks.performance_profile import performance_profiles
from gaitlab.errors import NotFound, OutputError, ProblemError
from gaitlab.report.performance_profile_figure import profile_figure

COLLECTION = Path(__file__).parents[3] / "shared" / "mpcc"


def row(problem, name, cost, objective=1.0, status="solved"):
    return Row(
        problem=problem, method=name, status=status, objective=objective, violation=0.0, complementarity=0.0,
        iterations=cost, seconds=cost / 10, sense=1,
    )  # fmt: skip


ROWS = [row("a", "x", 2), row("a", "y", 6), row("b", "x", 8), row("b", "y", 4), row("c", "y", 5), row("c", "x", 9, 3.0)]


def test_profiles_by_hand():
    """x: best on a, twice the best on b, the wrong optimum on c; y: thrice the best on a, best on b and c."""
    x, y = performance_profiles(ROWS, lambda each: each.iterations)
    np.testing.assert_allclose(x.ratios, [1.0, 2.0])
    np.testing.assert_allclose(x.parts, [1 / 3, 2 / 3])
    np.testing.assert_allclose(y.ratios, [1.0, 1.0, 3.0])


def test_the_figure_repeats_and_names_the_methods():
    panels = {"iterations": performance_profiles(ROWS, lambda each: each.iterations)}
    svg = profile_figure(panels)
    assert svg == profile_figure(panels)
    assert svg.lstrip().startswith("<?xml") and ">x<" in svg and ">y<" in svg


def test_rows_are_written_as_they_come(tmp_path):
    path = tmp_path / "out.csv"
    rows = write_rows(iter(ROWS), path)
    next(rows)
    header, first = list(csv.reader(path.read_text().splitlines()))
    assert header == "problem method status objective violation complementarity iterations seconds".split()
    assert first == ["a", "x", "solved", "1", "0", "0", "2", "0.2"]
    with pytest.raises(OutputError, match="nowhere"):
        list(write_rows(iter(ROWS), tmp_path / "nowhere" / "out.csv"))


def test_unknown_methods_and_empty_folders_are_refused(tmp_path):
    with pytest.raises(NotFound, match="penalty-ipopt"):
        method("penalty-gurobi")
    with pytest.raises(ProblemError, match="no problems here"):
        problem_files(tmp_path)
    (tmp_path / "reference.csv").write_text("problem,value\na,1\n")
    with pytest.raises(ProblemError, match="best_known"):
        read_reference(tmp_path)


def test_a_damaged_file_is_a_row_with_its_reason(tmp_path):
    (tmp_path / "broken.nl").write_text("g3 nonsense\n")
    (found,) = run_collection(tmp_path, ["penalty-ipopt"], 2, Limits(seconds=30.0))
    assert not found.solved
    assert "no readable header" in found.status


def test_a_method_that_hangs_or_crashes_is_a_row_with_its_reason(tmp_path, monkeypatch):
    (tmp_path / "any.nl").write_text("")
    (tmp_path / "hanging.py").write_text("import time\ntime.sleep(60)\n")
    (tmp_path / "crashing.py").write_text("import os\nos.abort()\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    for child, reason in (("hanging", "time limit"), ("crashing", "SIGABRT")):
        monkeypatch.setattr(mpcc_collection, "CHILD", child)
        (found,) = run_collection(tmp_path, ["penalty-ipopt"], 1, Limits(seconds=0.5))
        assert reason in found.status


@pytest.fixture
def collection():
    if not COLLECTION.is_dir():
        give_up = pytest.fail if os.environ.get("GAITLAB_REQUIRE_SHARED_DATA") else pytest.skip
        give_up(f"needs the problems in {COLLECTION}")
    return COLLECTION


@pytest.mark.shared_data
def test_a_sample_of_the_collection(collection, tmp_path):
    for name in ("bard2.nl", "bilevel1m.nl", "scholtes4.nl", "reference.csv"):
        shutil.copy(collection / name, tmp_path)
    reference = read_reference(tmp_path)
    rows = list(run_collection(tmp_path, ["penalty-ipopt"], 2, Limits()))
    assert [each.problem for each in rows if each.reaches(reference[each.problem])] == [each.problem for each in rows]
    assert max(each.violation for each in rows) <= 1e-6
    assert max(each.complementarity for each in rows) <= 1e-5


@pytest.mark.slow
@pytest.mark.shared_data
def test_the_whole_collection_by_the_best_method(collection):
    """Issue 3, line 5: 58 of 60 with five starts."""
    reference = read_reference(collection)
    reached = 0
    for each in run_collection(collection, ["penalty-ipopt"], 5, Limits()):
        best = reference.get(each.problem)
        if best is not None:
            close = abs(each.objective - best) <= 1e-3 * max(1.0, abs(best))
            reached += close and each.violation <= 1e-6 and each.complementarity <= 1e-5
    assert reached >= 58


def test_every_method_name_makes_a_method():
    assert len(METHODS) == 10
    assert all(hasattr(method(name), "prepare") for name in METHODS)
