import shutil

import pytest

from gaitlab.cli.app import run
from gaitlab.mocap.c3d import read_c3d
from gaitlab.pipelines import analyse

CHILD = "HC033A"


@pytest.fixture
def gaitlab(capsys):
    """Runs the command line; returns exit code, stdout, stderr."""

    def call(*arguments):
        code = run([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return call


@pytest.fixture(scope="session")
def files(shared_data, tmp_path_factory):
    """Static and walk of one child under short names."""
    folder = tmp_path_factory.mktemp("child")
    for role in ("static", "straight"):
        source = next((shared_data / "children" / CHILD).glob(f"{role}_*.c3d"))
        shutil.copy(source, folder / f"{role}.c3d")
    return folder


@pytest.fixture(scope="session")
def recordings(files):
    return {path.stem: read_c3d(path) for path in sorted(files.glob("*.c3d"))}


@pytest.fixture
def reads(monkeypatch):
    """Lets the command read recordings made by a test instead of files."""

    def replace_reader(**replaced):
        monkeypatch.setattr(analyse, "read_c3d", lambda path: replaced[path.stem])

    return replace_reader
