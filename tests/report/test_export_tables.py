import csv

import msgspec
import pytest
from exported_trial import exported_trial

from gaitlab.clinical.document import read_document
from gaitlab.errors import InvalidRecording
from gaitlab.report.export_tables import export_csv, export_json


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_values_with_units(tmp_path):
    folder = exported_trial(tmp_path / "result")
    paths = export_csv(folder, tmp_path / "walk")
    assert [path.name for path in paths] == ["walk_curves.csv", "walk_values.csv", "walk_events.csv"]
    found = {(r["part"], r["quantity"], r["side"], r["statistic"]): (r["value"], r["unit"]) for r in rows(paths[1])}
    assert found["spatiotemporal", "speed_m_per_s", "left", "mean"] == ("1.1", "m/s")
    assert found["spatiotemporal", "swing_percent", "left", "cycle 1"] == ("", "%")
    assert found["dimensionless", "speed", "right", "mean"] == ("0.4", "1")
    assert found["weights", "torque", "", "sd"] == ("0.06", "1")


def test_curves_and_events(tmp_path):
    folder = exported_trial(tmp_path / "result")
    curves, _, events = export_csv(folder, tmp_path / "walk")
    document = read_document(folder / "result.json")
    knee = next(r for r in rows(curves) if (r["curve"], r["side"], r["statistic"]) == ("knee_flexion", "left", "mean"))
    assert (knee["part"], knee["unit"], knee["n_cycles"]) == ("kinematics", "deg", "2")
    assert [float(knee[f"p{k}"]) for k in range(101)] == document.kinematics["knee_flexion"].left.mean
    assert len(rows(events)) == len(document.events)


def test_json_is_the_checked_document(tmp_path):
    folder = exported_trial(tmp_path / "result")
    export_json(folder, tmp_path / "walk.json")
    assert msgspec.structs.asdict(read_document(tmp_path / "walk.json")) == msgspec.structs.asdict(
        read_document(folder / "result.json")
    )


def test_a_broken_result_is_refused(tmp_path):
    (tmp_path / "result.json").write_text("{}")
    with pytest.raises(InvalidRecording, match="is not a gaitlab result"):
        export_csv(tmp_path, tmp_path / "walk")
