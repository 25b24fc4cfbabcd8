import random

import pytest
from synthetic_walk import Gait, synthetic_walk

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.c3d import write_c3d
from gaitlab.mocap.sandbox import ReaderLimits, read_raw

CHILDREN = {
    "crash": "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)",
    "abort": "import os, sys\nsys.stderr.write('terminate called: std::bad_alloc')\nsys.stderr.flush()\nos.abort()",
    "hang": "import time\ntime.sleep(60)",
    "refuse": "raise OSError('Parameter type unrecognized. See the manual')",
    "greedy": "bytearray(10**15)",
    "nothing": "",
}


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    path = tmp_path_factory.mktemp("walk") / "walk.c3d"
    write_c3d(path, synthetic_walk(Gait(duration=1.0)))
    return path


@pytest.mark.parametrize(
    ("child", "said"),
    [
        ("crash", "the C3D reader crashed on this file (SIGSEGV)"),
        ("abort", "needs more than 4 GB"),
        ("hang", "took longer than 1 s and was stopped"),
        ("refuse", "the C3D reader refused the file (Parameter type unrecognized)"),
        ("greedy", "needs more than 4 GB"),
        ("nothing", "returned nothing usable"),
    ],
)
def test_each_end_of_the_child_gives_one_sentence(walk, tmp_path, monkeypatch, child, said):
    (tmp_path / f"bad_child_{child}.py").write_text(CHILDREN[child])
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(InvalidRecording) as caught:
        read_raw(walk, ReaderLimits(seconds=1.0 if child == "hang" else 20.0), child=f"bad_child_{child}")
    assert said in str(caught.value)
    assert str(caught.value).startswith(f"{walk}: ")
    assert "\n" not in str(caught.value)


def test_memory_limit_holds_for_the_parser(walk):
    with pytest.raises(InvalidRecording, match=r"needs more than 0\.04 GB"):
        read_raw(walk, ReaderLimits(memory=40_000_000))


@pytest.mark.parametrize("seed", range(6))
def test_a_damaged_file_is_read_or_refused(walk, tmp_path, seed):
    chance = random.Random(seed)
    content = bytearray(walk.read_bytes())
    for _ in range(10):
        content[chance.randrange(512, 4000)] = chance.randrange(256)
    path = tmp_path / "damaged.c3d"
    path.write_bytes(content)
    try:
        read_raw(path, ReaderLimits(seconds=20.0))
    except InvalidRecording as error:
        assert "\n" not in str(error)
