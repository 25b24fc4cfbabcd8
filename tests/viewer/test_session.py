import socket
import time
import urllib.request

import numpy as np
import pytest
from synthetic_output import N_FRAMES, document, walk_arrays, write_output

from gaitlab.errors import OutputError
from gaitlab.viewer.motion import CONTACTS, FLOOR, MARKERS, MEASURED, OPTIMAL
from gaitlab.viewer.session import Session, view


@pytest.fixture
def port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def directory(tmp_path):
    return write_output(tmp_path / "walk_1", document(), walk_arrays())


@pytest.fixture
def session(directory, port):
    with Session(directory, port) as running:
        yield running


def test_it_answers_on_the_loopback_address(session, port):
    assert session.url == f"http://127.0.0.1:{port}"
    with urllib.request.urlopen(session.url, timeout=10) as answer:
        assert answer.status == 200


def test_scrubbing_shows_frame_and_phase(session):
    session.seek(0.5)
    assert (session.frame, session.phase, session.playing) == (50, "double support", False)


def test_playing_moves_time_and_stops(session):
    session.set_speed(1.0)
    session.play()
    deadline = time.monotonic() + 10.0
    while session.frame == 0 and time.monotonic() < deadline:
        time.sleep(0.02)
    session.play(False)
    stopped = session.frame
    time.sleep(0.1)
    assert 0 < stopped < N_FRAMES and session.frame == stopped


def test_layers_switch(session):
    session.set_layer(MARKERS, False)
    assert not session.scene.is_shown(MARKERS) and session.scene.is_shown(MEASURED)


def test_following_keeps_the_pelvis_over_one_place(session):
    first, last = session.scene.shift(0), session.scene.shift(N_FRAMES - 1)
    way = walk_arrays()["segment_positions_measured"][:, 0]
    assert way[0, :2] + first[:2] == pytest.approx(way[-1, :2] + last[:2])


def test_the_model_is_hidden_outside_its_strides(tmp_path, port):
    arrays = walk_arrays()
    for name in ("segment_positions_optimal", "forces_optimal"):
        arrays[name][:100] = np.nan
    with Session(write_output(tmp_path, document(), arrays), port) as session:
        session.seek(0.1)
        assert not session.scene.is_shown(OPTIMAL) and not session.scene.is_shown(CONTACTS)
        session.seek(1.5)
        assert session.scene.is_shown(OPTIMAL) and session.scene.is_shown(CONTACTS)


def test_another_trial_keeps_the_switches(tmp_path, port):
    directory = write_output(tmp_path / "out", document(), angles=False)
    for trial in ("walk_1", "walk_2"):
        write_output(directory / trial, document(trial), walk_arrays())
    with Session(directory, port) as session:
        session.set_layer(FLOOR, False)
        session.seek(1.0)
        session.select("walk_2")
        assert session.trials == ("walk_1", "walk_2") and session.frame == 0
        assert not session.scene.is_shown(FLOOR) and session.scene.is_shown(MARKERS)


def test_every_preset_can_be_asked_for(session):
    for preset in ("sagittal", "frontal", "oblique"):
        session.look(preset)


def test_it_prints_nothing(directory, port, capsys):
    with Session(directory, port):
        pass
    assert capsys.readouterr().out == ""


def test_a_busy_port_is_refused(session, directory, port):
    with pytest.raises(OutputError, match=f"port {port} on 127.0.0.1 cannot be used .*; choose another with --port"):
        Session(directory, port)


def test_a_directory_without_a_walk_is_refused(tmp_path, port):
    with pytest.raises(OutputError, match=r"has no walk\.npz; run 'gaitlab analyse'"):
        Session(write_output(tmp_path, document()), port)


def test_no_directory_is_refused(tmp_path):
    with pytest.raises(OutputError, match="is not a directory"):
        view(tmp_path / "nowhere")


def test_viewing_ends_with_an_interrupt(directory, port):
    opened = []

    def interrupt(url):
        opened.append(url)
        raise KeyboardInterrupt

    view(directory, port, on_open=interrupt)
    assert opened == [f"http://127.0.0.1:{port}"]
