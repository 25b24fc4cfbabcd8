"""One application for all tests of the API; each test makes the patients that it changes."""

import pytest
from web_world import running_world


@pytest.fixture(scope="session")
def world(tmp_path_factory):
    with running_world(tmp_path_factory.mktemp("web")) as running:
        yield running


@pytest.fixture
def case(world):
    """A patient of the test's own."""
    return world.make_case()
