import pytest
from synthetic_output import document, walk_arrays, write_output


@pytest.fixture
def one_walk(tmp_path):
    """Output directory of one walk, complete."""
    return write_output(tmp_path / "out", document(), walk_arrays())


@pytest.fixture
def two_walks(tmp_path):
    """Output directory of two walks: overall document, and a directory per trial."""
    directory = write_output(tmp_path / "out", document("walk_1"), angles=False)
    for trial in ("walk_1", "walk_2"):
        write_output(directory / trial, document(trial), walk_arrays())
    return directory
