"""The embedded server: who reaches it, how fast it starts, how it survives."""

import os
import signal
import socket
import subprocess
import sys
import time

import psycopg
import pytest
from sqlalchemy import make_url
from stored import open_folder

from gaitlab.errors import StorageError
from gaitlab.storage.embedded import LONGEST_SOCKET, SOCKET, EmbeddedPostgres

STRANGER = 61234
CONNECT = """
import os, socket, sys
os.setgroups([])
os.setgid(int(sys.argv[2]))
os.setuid(int(sys.argv[2]))
socket.socket(socket.AF_UNIX).connect(sys.argv[1])
"""


@pytest.fixture(scope="module")
def server():
    """A running server of its own."""
    server = EmbeddedPostgres(open_folder() / "data")
    server.start()
    yield server
    server.stop()


def socket_of(server):
    return make_url(server.url).query["host"] + "/" + SOCKET


def test_stops_and_starts_again_at_the_same_address(server):
    address = server.url
    server.stop()
    assert server.pid() is None
    assert server.start() == address


def test_trusts_nobody_without_the_password(server):
    without = make_url(server.url).set(password="wrong").render_as_string(hide_password=False)
    with pytest.raises(psycopg.OperationalError, match="password authentication failed"):
        psycopg.connect(without)


def test_listens_on_no_network_address(server):
    with psycopg.connect(server.url) as connection:
        assert connection.execute("SHOW listen_addresses").fetchone() == ("",)
        assert connection.execute("SHOW data_checksums").fetchone() == ("on",)
        assert connection.execute("SHOW fsync").fetchone() == ("on",)
        assert connection.execute("SELECT count(*) FROM pg_hba_file_rules WHERE auth_method = 'trust'").fetchone() == (
            0,
        )


def test_folders_are_closed_to_others(server):
    for path in (server.cluster, server.cluster.parent, os.path.dirname(socket_of(server))):
        assert os.stat(path).st_mode & 0o077 == 0


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can act as another user")
def test_another_local_user_cannot_reach_the_socket(server):
    command = [sys.executable, "-c", CONNECT, socket_of(server), str(STRANGER)]
    stranger = subprocess.run(command, capture_output=True, text=True)
    assert "PermissionError" in stranger.stderr
    with socket.socket(socket.AF_UNIX) as ours:
        ours.connect(socket_of(server))


def test_starts_again_after_a_kill_and_keeps_what_was_committed(server):
    with psycopg.connect(server.url, autocommit=True) as connection:
        connection.execute("CREATE TABLE kept AS SELECT 42 AS answer")
    pid = server.pid()
    os.kill(pid, signal.SIGKILL)
    while server.pid() == pid:
        time.sleep(0.01)
    assert server.ensure_running()
    assert not server.ensure_running()
    with psycopg.connect(server.url) as connection:
        assert connection.execute("SELECT answer FROM kept").fetchone() == (42,)


def test_stops_only_when_the_last_user_leaves(server):
    other = EmbeddedPostgres(server.cluster.parent.parent)
    other.start()
    other.stop()
    assert server.pid() is not None


def test_a_number_that_belongs_to_another_process_does_not_block_the_start(server):
    note = (server.cluster / "postmaster.pid").read_text()
    server.stop()
    (server.cluster / "postmaster.pid").write_text(f"{os.getppid()}\n" + note.split("\n", 1)[1])
    server.start()
    assert server.pid() not in (None, os.getppid())


def test_a_long_path_gets_a_closed_folder_for_its_socket_that_is_ours():
    folder = open_folder() / ("long" * 25)
    folder.mkdir(mode=0o711)
    server = EmbeddedPostgres(folder / "data")
    server.start()
    place = os.path.dirname(socket_of(server))
    assert len(socket_of(server)) <= LONGEST_SOCKET
    assert os.stat(place).st_mode & 0o077 == 0
    server.stop()
    os.rmdir(place)
    os.symlink("/tmp", place)
    with pytest.raises(StorageError, match="belongs to somebody else"):
        server.start()
    os.unlink(place)
