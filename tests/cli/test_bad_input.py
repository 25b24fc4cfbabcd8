"""Every kind of bad input ends with exit code 2 and one sentence that says what, where and what to do."""

from dataclasses import replace

import numpy as np
import pytest


def is_one_sentence(text):
    lines = text.strip().splitlines()
    return len(lines) == 1 and lines[0].startswith("gaitlab: ") and "Traceback" not in text


def last_line(err):
    # Progress bars share stderr with the message, which is its last line.
    return err.strip().splitlines()[-1] + "\n"


def assert_refused(result, *words):
    code, out, err = result
    message = last_line(err)
    assert code == 2, err
    assert "Traceback" not in err + out
    assert is_one_sentence(message), err
    missing = [word for word in words if word.lower() not in message.lower()]
    assert not missing, message


def moved(recording, frames, names=()):
    """The recording with these frames of the markers missing; of all markers by default."""
    markers = {name: x.copy() for name, x in recording.markers.items()}
    for name in names or markers:
        markers[name][frames] = np.nan
    return replace(recording, markers=markers)


def test_a_file_that_does_not_exist(gaitlab, tmp_path):
    result = gaitlab("analyse", tmp_path / "absent.c3d", "--out", tmp_path / "out")
    assert_refused(result, "absent.c3d", "no such file")


def test_a_file_that_is_no_c3d(gaitlab, tmp_path):
    (tmp_path / "letter.c3d").write_text("Dear colleague, " * 500)
    assert_refused(gaitlab("analyse", tmp_path / "letter.c3d", "--out", tmp_path / "out"), "letter.c3d", "C3D")


def test_an_empty_file(gaitlab, tmp_path):
    (tmp_path / "empty.c3d").touch()
    assert_refused(gaitlab("analyse", tmp_path / "empty.c3d", "--out", tmp_path / "out"), "empty.c3d")


def test_a_file_of_two_gigabytes(gaitlab, tmp_path):
    with (tmp_path / "huge.c3d").open("wb") as file:
        file.write(b"\x02\x50")
        file.truncate(2_000_000_000)
    assert_refused(gaitlab("analyse", tmp_path / "huge.c3d", "--out", tmp_path / "out"), "huge.c3d")


@pytest.mark.shared_data
def test_a_truncated_file(gaitlab, files, tmp_path):
    content = (files / "straight.c3d").read_bytes()
    (tmp_path / "cut.c3d").write_bytes(content[: len(content) // 2])
    assert_refused(gaitlab("analyse", tmp_path / "cut.c3d", "--out", tmp_path / "out"), "cut.c3d")


@pytest.mark.parametrize("blocker", ["a file", "below a file"])
def test_an_output_folder_that_cannot_be_written(gaitlab, tmp_path, blocker):
    (tmp_path / "taken").write_text("here already")
    out = tmp_path / "taken" if blocker == "a file" else tmp_path / "taken" / "deeper"
    assert_refused(gaitlab("analyse", tmp_path / "walk.c3d", "--out", out), "taken", "cannot be written", "choose")


@pytest.mark.parametrize(
    ("option", "word"),
    [
        (("--mass", "0"), "mass"),
        (("--mass", "-3"), "mass"),
        (("--mass", "nan"), "mass"),
        (("--height", "-1.2"), "height"),
        (("--height", "156"), "height"),
        (("--leg-length", "0"), "leg_length"),
        (("--parameter", "left_leg_length"), "left_leg_length"),
        (("--parameter", "shoe_size=42"), "available"),
        (("--criteria", "happiness"), "available"),
        (("--criteria", ""), "criterion"),
    ],
)
def test_impossible_options(gaitlab, tmp_path, option, word):
    assert_refused(gaitlab("analyse", tmp_path / "walk.c3d", "--out", tmp_path / "out", *option), word)


def test_options_that_do_not_exist(gaitlab, tmp_path):
    assert_refused(gaitlab("analyse", tmp_path / "walk.c3d", "--out", tmp_path / "out", "--statik", "s.c3d"), "statik")


def test_no_walk_at_all(gaitlab, tmp_path):
    assert_refused(gaitlab("analyse", "--out", tmp_path / "out"), "walks")


def test_two_walks_of_one_name(gaitlab, tmp_path):
    walks = (tmp_path / "a" / "walk.c3d", tmp_path / "b" / "walk.c3d")
    assert_refused(gaitlab("analyse", *walks, "--out", tmp_path / "out"), "walk", "rename")


def test_a_folder_that_gaitlab_did_not_write(gaitlab, tmp_path):
    assert_refused(gaitlab("view", tmp_path / "nothing"), "nothing", "folder")


@pytest.mark.shared_data
class TestContent:
    """Files that can be read but not be analysed."""

    @pytest.fixture
    def static(self, recordings):
        return recordings["static"]

    @pytest.fixture
    def walk(self, recordings):
        return recordings["straight"]

    @pytest.fixture
    def analysed(self, gaitlab, reads, tmp_path):
        def call(walk, static=None, *options):
            reads(walk=walk, static=static)
            trials = ("walk.c3d",) if static is None else ("--static", "static.c3d", "walk.c3d")
            return gaitlab("analyse", *trials, "--out", tmp_path / "out", "--no-weights", *options)

        return call

    def test_no_static_and_no_parameters(self, analysed, walk):
        assert_refused(analysed(replace(walk, parameters={})), "static", "leg length")

    def test_no_mass(self, analysed, walk, static):
        def light(recording):
            return replace(recording, parameters={k: v for k, v in recording.parameters.items() if k != "mass"})

        assert_refused(analysed(light(walk), light(static)), "mass", "--mass")

    def test_no_full_stride(self, analysed, walk, static):
        short = {name: x[:30] for name, x in walk.markers.items()}
        assert_refused(analysed(replace(walk, markers=short, events=()), static), walk.name, "stride", "longer")

    def test_no_markers(self, analysed, walk, static):
        assert_refused(analysed(replace(walk, markers={}), static), walk.name, "marker")

    def test_markers_of_another_model(self, analysed, walk, static):
        renamed = {f"X{number}": x for number, x in enumerate(walk.markers.values())}
        assert_refused(analysed(replace(walk, markers=renamed), static), walk.name, "LASI")

    def test_markers_missing_for_a_whole_stance(self, analysed, walk, static):
        strikes = [event for event in walk.events if event.kind == "foot_strike"]
        start, end = (int(event.time * walk.rate) for event in (strikes[0], strikes[-1]))
        names = ("LANK", "LHEE", "LTOE", "RANK", "RHEE", "RTOE")
        assert_refused(analysed(moved(walk, slice(start + 5, end - 5), names), static), walk.name, "LANK", "fill")

    def test_nothing_but_nan(self, analysed, walk, static):
        assert_refused(analysed(moved(walk, slice(None)), static), walk.name)

    def test_a_static_of_nothing_but_nan(self, analysed, walk, static):
        assert_refused(analysed(walk, moved(static, slice(None))), static.name)

    def test_a_static_given_as_walk(self, analysed, static):
        assert_refused(analysed(static, static), static.name)
