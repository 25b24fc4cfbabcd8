"""What makes two jobs equal, and which names files may have."""

from dataclasses import replace
from uuid import UUID, uuid4

import pytest

from gaitlab.errors import InvalidRecording
from gaitlab.jobs.computations.registry import MODULES
from gaitlab.jobs.request import QUEUES, JobInput, JobRequest
from gaitlab.storage.models import JobKind

INPUT = JobInput(role="walk", name="walk.c3d", sha256="0" * 64, source=UUID(int=1))
REQUEST = JobRequest(kind=JobKind.ANALYSE, inputs=(INPUT,), patients=frozenset({UUID(int=2)}), settings={"seed": 0})


def test_equal_requests_have_one_hash_whoever_asks():
    assert replace(REQUEST, created_by=uuid4(), priority=5, request_id="a").input_hash == REQUEST.input_hash


@pytest.mark.parametrize(
    "change",
    [
        {"kind": JobKind.PREDICT},
        {"settings": {"seed": 1}},
        {"session_id": UUID(int=3)},
        {"patients": frozenset({UUID(int=4)})},
        {"inputs": (replace(INPUT, sha256="1" * 64),)},
        {"inputs": (replace(INPUT, role="static"),)},
    ],
)
def test_whatever_changes_the_result_or_its_owner_changes_the_hash(change):
    assert replace(REQUEST, **change).input_hash != REQUEST.input_hash


@pytest.mark.parametrize("name", ["", "../walk.c3d", "/etc/passwd", "a/../../b", "a\\b", "a\x00b"])
def test_a_name_never_leaves_the_folder(name):
    with pytest.raises(InvalidRecording, match="no file name"):
        replace(INPUT, name=name)


def test_every_kind_has_a_queue_and_a_computation():
    assert set(QUEUES) == set(JobKind)
    assert set(MODULES) == {kind.value for kind in JobKind}
