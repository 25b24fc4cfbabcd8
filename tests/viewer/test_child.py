import json
import stat
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import httpx
import pytest
from synthetic_output import document, walk_arrays, write_output
from websockets.sync.client import unix_connect

from gaitlab.viewer.child import obey
from gaitlab.viewer.export import export_html


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("viewer")


@pytest.fixture(scope="module")
def directory(folder):
    return write_output(folder / "walk_1", document(), walk_arrays())


def start(directory, socket):
    command = [sys.executable, "-m", "gaitlab.viewer.child", str(directory), str(socket)]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def state(child, wanted):
    """The first reported state that fits; the child ends the stream when it dies, so this ends, too."""
    return next(found for line in child.stdout if wanted(found := json.loads(line)))


@pytest.fixture(scope="module")
def child(directory, folder):
    with start(directory, folder / "socket") as process:
        assert json.loads(process.stdout.readline()) == {"trials": ["walk_1"]}
        yield process
        process.stdin.close()
        assert process.wait(10) == 0


def test_it_serves_page_and_socket_through_a_private_file_and_no_port(child, folder):
    socket = folder / "socket"
    assert stat.S_IMODE(socket.stat().st_mode) & 0o077 == 0
    with httpx.Client(transport=httpx.HTTPTransport(uds=str(socket))) as client:
        assert "<html" in client.get("http://viewer/").text
    with unix_connect(str(socket), "ws://viewer/", subprotocols=["viser-v1.1.1"], max_size=None) as connection:
        assert len(connection.recv(timeout=10)) > 0
    inodes = {link.readlink().name for link in Path(f"/proc/{child.pid}/fd").iterdir() if link.is_symlink()}
    listening = [line for line in Path("/proc/net/tcp").read_text().splitlines() if " 0A " in line]
    assert not [line for line in listening if f"socket:[{line.split()[9]}]" in inodes]


def test_commands_move_it_and_its_state_is_told(child):
    child.stdin.write('{"seek": 0.5}\n')
    child.stdin.flush()
    assert state(child, lambda told: told["frame"] == 50)["phase"] == "double support"
    child.stdin.write('{"speed": 0.25, "play": true}\n')
    child.stdin.flush()
    assert state(child, lambda told: told["playing"] and told["frame"] > 50)["speed"] == 0.25


def test_nonsense_is_left_alone():
    session = Mock()
    for line in ("", "[1]", "{", '{"seek": "x"}', '{"seek": null}', '{"explode": 1}', "[" * 100_000):
        obey(session, line)
    assert session.method_calls == []


def test_it_says_why_there_is_nothing_to_show(tmp_path):
    with start(tmp_path / "nowhere", tmp_path / "socket") as process:
        assert "is not a directory" in json.loads(process.stdout.readline())["error"]
    assert process.returncode == 1


def test_a_scene_is_exported_as_one_page(directory, tmp_path):
    page = tmp_path / "scene.html"
    export_html(directory, page)
    text = page.read_text()
    assert "__VISER_EMBED_DATA__=" in text and 'src="http' not in text


def test_an_export_of_nothing_says_why(tmp_path):
    command = [sys.executable, "-m", "gaitlab.viewer.export", str(tmp_path / "none"), str(tmp_path / "x.html")]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    assert finished.returncode == 1 and finished.stderr.startswith("the result is not a directory")
