import json
import math
from pathlib import Path

import msgspec
import pytest

from gaitlab.clinical.document import (
    Curve,
    CurveSides,
    Document,
    InputFile,
    QualityEntry,
    SpatiotemporalEntry,
    SubjectEntry,
    WeightsEntry,
    encode,
    read_document,
    schema,
    write_document,
)
from gaitlab.errors import InvalidRecording, OutputError

DOCS = Path(__file__).parents[2] / "docs" / "result.md"


@pytest.fixture
def document():
    curve = Curve(mean=[1.0, math.nan], sd=[None, None], n_cycles=1)
    return Document(
        version="0",
        inputs=[InputFile(name="walk.c3d", role="walk", sha256="0" * 64, rate_hz=100.0, n_frames=2)],
        subject=SubjectEntry(mass_kg=40.0),
        events=[],
        spatiotemporal=SpatiotemporalEntry(),
        kinematics={"hip_flexion": CurveSides(left=curve)},
        weights=None,
        quality=QualityEntry(),
        settings={"seed": 0},
        warnings=["a sentence"],
    )


def test_nan_is_written_as_null(document):
    content = json.loads(encode(document), parse_constant=pytest.fail)
    assert content["kinematics"]["hip_flexion"]["left"]["mean"] == [1.0, None]


def test_what_is_written_can_be_read(document, tmp_path):
    write_document(document, tmp_path / "result.json")
    assert encode(read_document(tmp_path / "result.json")) == encode(document)


def test_a_broken_result_is_refused(tmp_path):
    (tmp_path / "result.json").write_text('{"version": 1}')
    with pytest.raises(InvalidRecording, match="not a gaitlab result"):
        read_document(tmp_path / "result.json")


def test_a_folder_that_does_not_exist_cannot_be_written(document, tmp_path):
    with pytest.raises(OutputError, match="choose a folder"):
        write_document(document, tmp_path / "absent" / "result.json")


def test_the_schema_accepts_what_is_written(document):
    required = set(schema()["$defs"]["Document"]["required"])
    assert required <= set(json.loads(encode(document)))


@pytest.mark.parametrize("struct", [Document, WeightsEntry])
def test_every_key_is_documented(struct):
    text = DOCS.read_text()
    missing = [field.encode_name for field in msgspec.structs.fields(struct) if f"`{field.encode_name}" not in text]
    assert not missing
