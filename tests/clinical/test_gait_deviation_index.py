import zipfile
from xml.sax.saxutils import escape

import numpy as np
import pytest

from gaitlab.clinical.deviation_workbook import import_basis
from gaitlab.clinical.gait_deviation_index import (
    DeviationBasis,
    gait_deviation_index,
    gait_vector,
    read_basis,
    write_basis,
)
from gaitlab.clinical.gait_profile import VARIABLES
from gaitlab.errors import InvalidReference

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"


@pytest.fixture
def basis():
    rng = np.random.default_rng(0)
    features = np.linalg.qr(rng.normal(size=(459, 15)))[0].T
    mean = rng.normal(size=15)
    return DeviationBasis(
        name="made up",
        source="a test",
        features=features.tolist(),
        control_mean=mean.tolist(),
        log_distance_mean=2.0,
        log_distance_sd=0.3,
    )


def curves_of(vector):
    """Curves whose every second sample are the parts of a gait vector."""
    parts = np.reshape(vector, (9, 51))
    return {
        name: np.interp(np.arange(101), np.arange(0, 101, 2), part) for name, part in zip(VARIABLES, parts, strict=True)
    }


def at_distance(basis, distance):
    """A gait vector whose features lie that far from the controls' mean."""
    point = np.array(basis.control_mean) + distance * np.eye(15)[3]
    return np.array(basis.features).T @ point


def test_the_gait_vector_is_the_nine_curves_one_after_the_other():
    vector = np.random.default_rng(1).normal(size=459)
    assert gait_vector(curves_of(vector)) == pytest.approx(vector)


@pytest.mark.parametrize(("deviations", "expected"), [(0.0, 100.0), (1.0, 90.0), (-2.0, 120.0)])
def test_ten_points_are_one_standard_deviation_of_the_ln_distance(basis, deviations, expected):
    vector = at_distance(basis, np.exp(2.0 + 0.3 * deviations))
    assert gait_deviation_index(basis, curves_of(vector)) == pytest.approx(expected)


def test_without_a_curve_there_is_no_index(basis):
    curves = curves_of(at_distance(basis, 1.0))
    del curves["foot_progression"]
    assert gait_deviation_index(basis, curves) is None


def test_a_basis_survives_its_file(basis, tmp_path):
    write_basis(basis, tmp_path / "basis.json")
    assert read_basis(tmp_path / "basis.json") == basis


def test_features_that_are_not_orthonormal_are_refused(basis, tmp_path):
    twice = [[2.0 * x for x in row] for row in basis.features]
    write_basis(
        DeviationBasis(**{**{f: getattr(basis, f) for f in basis.__struct_fields__}, "features": twice}),
        tmp_path / "basis.json",
    )
    with pytest.raises(InvalidReference, match="not orthonormal"):
        read_basis(tmp_path / "basis.json")


def cell(row, column, value):
    letters = ""
    number = column + 1
    while number:
        number, rest = divmod(number - 1, 26)
        letters = chr(ord("A") + rest) + letters
    place = f'r="{letters}{row + 1}"'
    if isinstance(value, str):
        return f'<c {place} t="inlineStr"><is><t>{escape(value)}</t></is></c>'
    return f"<c {place}><v>{value!r}</v></c>"


def write_workbook(path, *sheets):
    with zipfile.ZipFile(path, "w") as archive:
        for number, rows in enumerate(sheets, 1):
            body = "".join(
                f"<row>{''.join(cell(r, c, v) for c, v in enumerate(row) if v is not None)}</row>"
                for r, row in enumerate(rows)
            )
            sheet = f'<worksheet xmlns="{MAIN}"><sheetData>{body}</sheetData></worksheet>'
            archive.writestr(f"xl/worksheets/sheet{number}.xml", sheet)


def feature_sheet(basis):
    header = ["row", *(f"feature {k}" for k in range(15))]
    columns = zip(*basis.features, strict=True)
    return [header, *([float(k), *row] for k, row in enumerate(columns))]


def test_the_printed_layout_is_imported(basis, tmp_path):
    numbers = [["control mean features", *basis.control_mean], ["mean of ln (distance)", 2.0], ["sd of ln", 0.3]]
    write_workbook(tmp_path / "gdi.xlsx", feature_sheet(basis), numbers)
    read = import_basis(tmp_path / "gdi.xlsx", "a test")
    assert (read.features, read.control_mean) == (basis.features, basis.control_mean)
    assert (read.log_distance_mean, read.log_distance_sd) == (2.0, 0.3)


def test_controls_give_mean_and_sample_deviation(basis, tmp_path):
    controls = np.random.default_rng(3).normal(size=(459, 20))
    sheet = [[f"control {k}" for k in range(20)], *controls.tolist()]
    write_workbook(tmp_path / "gdi.xlsx", feature_sheet(basis), sheet)
    read = import_basis(tmp_path / "gdi.xlsx", "a test")
    vectors = controls.T @ np.array(basis.features).T
    logs = np.log(np.sqrt(((vectors - vectors.mean(axis=0)) ** 2).sum(axis=1)))
    assert read.control_mean == pytest.approx(vectors.mean(axis=0))
    assert read.log_distance_sd == pytest.approx(np.sqrt(((logs - logs.mean()) ** 2).sum() / 19))


def test_a_workbook_without_controls_is_refused(basis, tmp_path):
    write_workbook(tmp_path / "gdi.xlsx", feature_sheet(basis))
    with pytest.raises(InvalidReference, match="neither gait vectors of controls"):
        import_basis(tmp_path / "gdi.xlsx", "a test")


@pytest.mark.parametrize("content", [b"", b"no workbook"])
def test_what_is_no_workbook_is_refused(tmp_path, content):
    (tmp_path / "gdi.xlsx").write_bytes(content)
    with pytest.raises(InvalidReference, match="no .xlsx workbook"):
        import_basis(tmp_path / "gdi.xlsx", "a test")
