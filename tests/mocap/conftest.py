"""The real recordings, read once for all tests of this folder."""

import pytest

from gaitlab.mocap.c3d import read_c3d


@pytest.fixture(scope="session")
def real_recordings(shared_data):
    """All shared C3D files by file name."""
    return {path.name: read_c3d(path) for path in sorted(shared_data.glob("**/*.c3d"))}
