import csv
import xml.etree.ElementTree as ElementTree

import pyarrow.parquet
import pytest
from synthetic_output import document, write_output

from gaitlab.report.colours import PALETTES

FIGURES = ("curves", "scores", "spatiotemporal", "weights")
TABLES = ("quantities", "weights", "curves", "bands", "missing")


@pytest.fixture
def folders(tmp_path):
    names = ("before", "after", "later")
    return [write_output(tmp_path / name, document(name), angles=False) for name in names]


def table(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_tables_and_figures_are_written(gaitlab, folders, tmp_path):
    code, out, err = gaitlab("compare", *folders, "--out", tmp_path / "out")
    assert code == 0, err
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        *(f"{name}.csv" for name in TABLES),
        *(f"{name}.svg" for name in FIGURES),
    }
    assert "Compared with before" in out
    rows = table(tmp_path / "out" / "quantities.csv")
    assert {row["result"] for row in rows} == {"before", "after", "later"}


def test_figures_stand_alone(gaitlab, folders, tmp_path):
    assert gaitlab("compare", *folders, "--out", tmp_path / "out")[0] == 0
    for name in FIGURES:
        root = ElementTree.parse(tmp_path / "out" / f"{name}.svg").getroot()
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert any(element.tag.endswith("style") for element in root.iter())


def test_sides_may_have_colours_for_every_eye(gaitlab, folders, tmp_path):
    assert gaitlab("compare", *folders, "--out", tmp_path / "out", "--colours", "safe")[0] == 0
    drawn = (tmp_path / "out" / "curves.svg").read_text()
    assert all(colour in drawn for colour in PALETTES["safe"].values())
    assert not [colour for colour in PALETTES["safe"] if colour in drawn]


def test_groups_get_bands(gaitlab, folders, tmp_path):
    arguments = (f"cp={folders[0]}", f"cp={folders[1]}", f"norm={folders[2]}")
    assert gaitlab("compare", *arguments, "--out", tmp_path / "out")[0] == 0
    rows = table(tmp_path / "out" / "bands.csv")
    assert {(row["group"], row["n_results"]) for row in rows} == {("cp", "2"), ("norm", "1")}
    assert "cp (n = 2)" in (tmp_path / "out" / "curves.svg").read_text()


def test_parquet_holds_the_same_cells(gaitlab, folders, tmp_path):
    assert gaitlab("compare", *folders, "--out", tmp_path / "out", "--parquet")[0] == 0
    for name in TABLES:
        stored = pyarrow.parquet.read_table(tmp_path / "out" / f"{name}.parquet")
        assert stored.num_rows == len(table(tmp_path / "out" / f"{name}.csv"))
    weights = pyarrow.parquet.read_table(tmp_path / "out" / "weights.parquet").to_pylist()
    assert weights[0]["weight"] == 0.55 and weights[3]["sd"] is None


def test_a_folder_without_a_result_is_left_out_and_said(gaitlab, folders, tmp_path):
    (tmp_path / "empty").mkdir()
    code, out, _ = gaitlab("compare", *folders, tmp_path / "empty", "--out", tmp_path / "out")
    assert code == 0 and "empty left out" in out


def test_nothing_readable_is_refused(gaitlab, tmp_path):
    code, _, err = gaitlab("compare", tmp_path, "--out", tmp_path / "out")
    assert code == 2 and "left out" in err


def test_minimal_differences_can_be_given(gaitlab, folders, tmp_path):
    (tmp_path / "least.csv").write_text("quantity,value,source\nspeed_m_per_s,0.1,a study\n")
    arguments = ("compare", *folders, "--out", tmp_path / "out", "--minimal", tmp_path / "least.csv")
    assert gaitlab(*arguments)[0] == 0
    speed = next(row for row in table(tmp_path / "out" / "quantities.csv") if row["quantity"] == "speed_m_per_s")
    assert (speed["minimal_difference"], speed["source"]) == ("0.1", "a study")


def test_a_broken_list_of_minimal_differences_is_refused(gaitlab, folders, tmp_path):
    (tmp_path / "least.csv").write_text("name\nspeed\n")
    arguments = ("compare", *folders, "--out", tmp_path / "out", "--minimal", tmp_path / "least.csv")
    code, _, err = gaitlab(*arguments)
    assert code == 2 and "columns quantity, value and source" in err


def test_results_in_folders_of_one_name_keep_apart(gaitlab, tmp_path):
    folders = [write_output(tmp_path / name / "out", document(), angles=False) for name in ("anna", "ben")]
    assert gaitlab("compare", *folders, "--out", tmp_path / "compared")[0] == 0
    rows = table(tmp_path / "compared" / "quantities.csv")
    assert {row["result"] for row in rows} == {"anna/out", "ben/out"}
