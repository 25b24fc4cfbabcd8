"""Damaged recordings and very large files, sent to a web process of its own."""

import pytest
from hostile_uploads import look_into, send_mutated
from large_upload import WAYS, memory_of_upload
from web_world import world_in_a_process

pytestmark = pytest.mark.slow
MUTATED, LOOKED_INTO = 500, 30
MOST_MEMORY = 100e6  # bytes
STUCK = 600.0  # s
MORE_HANDLES = 5


@pytest.fixture(scope="module")
def clinic(tmp_path_factory):
    with world_in_a_process(tmp_path_factory.mktemp("hostile")) as running:
        yield running


def test_damaged_recordings_neither_crash_the_web_process_nor_leave_anything_behind(clinic):
    world, process = clinic
    report = send_mutated(world, process, MUTATED)
    assert report.unexpected == [] and min(report.taken, report.refused) > 0
    assert report.alive and report.handles <= MORE_HANDLES and report.spooled == 0
    assert look_into(world, LOOKED_INTO, STUCK) == 0


@pytest.mark.parametrize("way", WAYS)
def test_a_large_upload_needs_little_memory(clinic, way):
    world, process = clinic
    assert memory_of_upload(world, process, way) <= MOST_MEMORY
