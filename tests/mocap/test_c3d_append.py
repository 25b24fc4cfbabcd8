from dataclasses import replace

import ezc3d
import numpy as np
import pytest
from synthetic_walk import Gait, rectangle, synthetic_walk, with_plate, write_variant

from gaitlab.errors import InvalidRecording, OutputError
from gaitlab.mocap.c3d import extract, read_c3d, write_c3d
from gaitlab.mocap.c3d_append import append_here, append_outputs
from gaitlab.mocap.point_output import PointOutput, load_outputs, save_outputs

WALK = with_plate(synthetic_walk(Gait(duration=2.5)), 0.5, 1.1, rectangle(0.2, 0.3))
N = WALK.n_frames


def output(label="LHipAngles", kind="ANGLES", scale=40.0, seed=0):
    values = scale * np.random.default_rng(seed).normal(size=(N, 3))
    return PointOutput(label=label, kind=kind, values=values, meaning="flexion, adduction, rotation")


OUTPUTS = (output(), output("LHipMoment", "MOMENTS", 1.0, 1), output("LHipPower", "POWERS", 2.0, 2))


@pytest.fixture
def source(tmp_path):
    write_c3d(tmp_path / "walk.c3d", WALK)
    return tmp_path / "walk.c3d"


def states_units(**units):
    def change(c3d):
        for name, unit in units.items():
            c3d.add_parameter("POINT", name, [unit])

    return change


def test_what_is_appended_is_read_back(source, tmp_path):
    append_outputs(source, tmp_path / "copy.c3d", OUTPUTS)
    read = read_c3d(tmp_path / "copy.c3d").model_outputs
    for each, factor in zip(OUTPUTS, (1.0, 1000.0, 1.0), strict=True):
        assert read[each.label] / factor == pytest.approx(each.values, abs=1e-4)


def test_points_have_their_type_and_unit(source, tmp_path):
    append_here(source, OUTPUTS, tmp_path / "copy.c3d")
    raw = extract(tmp_path / "copy.c3d")
    for each, unit, value in zip(OUTPUTS, ("ANGLE", "MOMENT", "POWER"), ("deg", "Nmm/kg", "W/kg"), strict=True):
        assert raw.texts("POINT", each.kind) == (each.label,)
        assert raw.texts("POINT", f"{unit}_UNITS") == (value,)
    assert raw.texts("GAITLAB", "LABELS") == tuple(each.label for each in OUTPUTS)
    assert raw.texts("GAITLAB", "MEANING")[0] == "flexion, adduction, rotation"


def test_everything_else_stays(source, tmp_path):
    before = ezc3d.c3d(str(source))
    append_here(source, OUTPUTS, tmp_path / "copy.c3d")
    after = ezc3d.c3d(str(tmp_path / "copy.c3d"))
    n = before["data"]["points"].shape[1]
    assert np.array_equal(before["data"]["analogs"], after["data"]["analogs"])
    assert np.array_equal(before["data"]["points"], after["data"]["points"][:, :n], equal_nan=True)
    for name in ("residuals", "camera_masks"):
        assert np.array_equal(before["data"]["meta_points"][name], after["data"]["meta_points"][name][:, :n])
    old, new = extract(source).parameters, extract(tmp_path / "copy.c3d").parameters
    changed = {("POINT", "LABELS"), ("POINT", "USED"), ("POINT", "DESCRIPTIONS")}
    for group, members in old.items():
        for name, value in members.items():
            if (group, name) not in changed and name != "DATA_START":  # where the data begin in the file
                assert np.array_equal(np.asarray(value), np.asarray(new[group][name])), (group, name)
    assert source.read_bytes() != (tmp_path / "copy.c3d").read_bytes()


def test_unknown_frames_are_missing_ones(source, tmp_path):
    gap = output()
    gap.values[5:9, 1] = np.nan
    append_here(source, [gap], tmp_path / "copy.c3d")
    read = read_c3d(tmp_path / "copy.c3d").model_outputs["LHipAngles"]
    assert np.isnan(read[5:9]).all() and np.isfinite(np.delete(read, np.s_[5:9], axis=0)).all()


@pytest.mark.parametrize(
    ("units", "factors"),
    [({"MOMENT_UNITS": "Nm", "ANGLE_UNITS": "rad"}, (np.pi / 180.0, 1.0)), ({"MOMENT_UNITS": "N.mm"}, (1.0, 1000.0))],
)
def test_units_of_the_file_are_kept(tmp_path, units, factors):
    write_variant(tmp_path / "walk.c3d", WALK, states_units(**units))
    append_here(tmp_path / "walk.c3d", OUTPUTS, tmp_path / "copy.c3d")
    read = read_c3d(tmp_path / "copy.c3d").model_outputs
    for each, factor in zip(OUTPUTS, factors, strict=False):
        assert read[each.label] == pytest.approx(factor * each.values, rel=1e-6, abs=1e-6)


def test_an_unknown_unit_is_named(tmp_path):
    write_variant(tmp_path / "walk.c3d", WALK, states_units(MOMENT_UNITS="lbf in"))
    with pytest.raises(InvalidRecording, match="POINT:MOMENT_UNITS of the file is 'lbf in'"):
        append_outputs(tmp_path / "walk.c3d", tmp_path / "copy.c3d", OUTPUTS)


def test_labels_of_the_file_are_not_overwritten(source, tmp_path):
    append_here(source, OUTPUTS, tmp_path / "once.c3d")
    append_here(tmp_path / "once.c3d", [replace(OUTPUTS[0], values=0.5 * OUTPUTS[0].values)], tmp_path / "twice.c3d")
    read = read_c3d(tmp_path / "twice.c3d").model_outputs
    assert read["LHipAngles"] == pytest.approx(OUTPUTS[0].values, abs=1e-4)
    assert read["LHipAngles_gaitlab"] == pytest.approx(0.5 * OUTPUTS[0].values, abs=1e-4)


def test_lists_longer_than_a_parameter_go_on_in_the_next(source, tmp_path):
    many = [output(f"P{k}", seed=k) for k in range(300)]
    append_here(source, many[:240], tmp_path / "first.c3d")
    append_here(tmp_path / "first.c3d", many[240:], tmp_path / "copy.c3d")
    raw = extract(tmp_path / "copy.c3d")
    assert raw.labels[-300:] == raw.numbered_texts("GAITLAB", "LABELS") == tuple(each.label for each in many)
    assert raw.numbered_texts("POINT", "ANGLES") == tuple(each.label for each in many)


def test_texts_in_another_encoding_do_not_stop_it(source, tmp_path):
    latin = source.read_bytes().replace(b"Nmm", "N\u00b5m".encode("latin-1"))
    (tmp_path / "latin.c3d").write_bytes(latin)
    append_here(tmp_path / "latin.c3d", OUTPUTS, tmp_path / "copy.c3d")
    assert "N\u00b5m" in extract(tmp_path / "copy.c3d").texts("ANALOG", "UNITS")


def test_results_of_another_recording_are_refused(source, tmp_path):
    short = replace(OUTPUTS[0], values=OUTPUTS[0].values[:-1])
    with pytest.raises(InvalidRecording, match="frames, the file has"):
        append_here(source, [short], tmp_path / "copy.c3d")


def test_a_folder_that_is_not_there_is_named(source, tmp_path):
    with pytest.raises(OutputError, match="cannot be written"):
        append_outputs(source, tmp_path / "absent" / "copy.c3d", OUTPUTS)


def test_outputs_travel_between_processes(tmp_path):
    save_outputs(tmp_path / "outputs.npz", OUTPUTS)
    for read, written in zip(load_outputs(tmp_path / "outputs.npz"), OUTPUTS, strict=True):
        assert (read.label, read.kind, read.meaning) == (written.label, written.kind, written.meaning)
        assert np.array_equal(read.values, written.values)
