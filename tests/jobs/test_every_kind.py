"""Every kind of job for real, ordered, followed and fetched through the API of a whole service."""

import hashlib
import io
import json

import ezc3d
import numpy as np
import pyarrow.parquet
import pytest
from stored import new_database, url_of
from whole_service import DEMO, WholeService

pytestmark = pytest.mark.slow
SECONDS = 900.0
FASTER = 1.05


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    service = WholeService(tmp_path_factory.mktemp("kinds") / "data", url=url_of(new_database()))
    try:
        service.start()
        service.make_first_account()
        yield service
    finally:
        service.stop()


def result_of(service, job_id):
    """The result of a job once it is there."""
    job = service.wait(lambda: (found := service.job(job_id))["finished_at"] and found, SECONDS)
    assert job["status"] == "succeeded", job["error"]
    return service.client.get(f"/api/v1/results/{job['result_id']}").json()


def order(service, **body):
    return result_of(service, service.post("analyses", body)["id"])


def fetch(service, address):
    answer = service.client.get(f"/api/v1/{address}")
    assert answer.status_code == 200, answer.text
    return answer.content


@pytest.fixture(scope="module")
def visit(service):
    return service.make_visit()


@pytest.fixture(scope="module")
def analysed(service, visit):
    """An analysis with everything, followed by its events; the result, and what the events told."""
    job_id, told = service.post("analyses", {"kind": "analyse", "session_id": visit})["id"], []
    with service.client.stream("GET", f"/api/v1/analyses/{job_id}/events", timeout=SECONDS) as events:
        lines = events.iter_lines()
        for line in lines:
            if line.startswith("event: "):
                told.append((line.removeprefix("event: "), json.loads(next(lines).removeprefix("data: "))))
    return result_of(service, job_id), told


def exported(service, analysed, kind, choice=""):
    return fetch(service, f"results/{analysed[0]['id']}/exports/{kind}{choice}")


def test_what_is_in_an_upload_is_looked_into_by_itself(service, visit):
    address = f"sessions/{visit}/recordings"

    def looked_into():
        found = json.loads(fetch(service, address))
        found = found if isinstance(found, list) else found["items"]
        return all(each["inspection"] for each in found) and found

    recordings = {each["name"]: each for each in service.wait(looked_into, SECONDS)}
    points = ezc3d.c3d(str(DEMO / "walk1.c3d"))["parameters"]["POINT"]
    rows = dict(map(tuple, recordings["walk1.c3d"]["inspection"]["rows"]))
    assert str(points["FRAMES"]["value"][0]) in json.dumps(rows)
    assert {name: each["kind"] for name, each in recordings.items()} == {"static.c3d": "static", "walk1.c3d": "walk"}


def test_events_tell_of_an_analysis_from_its_start_to_its_end(analysed):
    names = [name for name, _ in analysed[1]]
    assert names[0] == names[-1] == "job" and names.count("progress") > 3
    assert analysed[1][-1][1]["status"] == "succeeded"
    assert len({each["stage"] for name, each in analysed[1] if name == "progress"}) > 2


def test_a_result_says_where_it_comes_from(analysed):
    result = analysed[0]
    come = result["provenance"]
    hashes = {each["name"]: each["sha256"] for each in come["inputs"]}
    assert hashes == {n: hashlib.sha256((DEMO / n).read_bytes()).hexdigest() for n in ("static.c3d", "walk1.c3d")}
    assert {"environment", "settings", "seed", "machine", "seconds", "worker", "attempt"} <= set(come)
    assert come["seconds"] > 1 and come["machine"] and "casadi" in json.dumps(come["environment"])
    assert sum(result["summary"]["weights"].values()) == pytest.approx(1.0, abs=1e-6)


def test_every_export_is_a_file_of_its_format(service, analysed, tmp_path):
    document = json.loads(exported(service, analysed, "json"))
    assert document["weights"] and document["kinematics"]
    assert exported(service, analysed, "csv").count(b"\n") > 50
    table = pyarrow.parquet.read_table(io.BytesIO(exported(service, analysed, "parquet")))
    assert table.num_rows > 50
    with np.load(io.BytesIO(exported(service, analysed, "npz"))) as arrays:
        assert len(arrays.files) > 3
    assert exported(service, analysed, "html").lstrip().startswith(b"<!")
    assert b"__VISER_EMBED_DATA__" in exported(service, analysed, "scene")
    (tmp_path / "walk.c3d").write_bytes(exported(service, analysed, "c3d"))
    kept, given = (ezc3d.c3d(str(path))["data"]["points"] for path in (tmp_path / "walk.c3d", DEMO / "walk1.c3d"))
    assert kept.shape[1] > given.shape[1] and kept.shape[2] == given.shape[2]
    assert json.loads(exported(service, analysed, "fhir"))["resourceType"] == "Bundle"
    for kind in ("trc", "mot"):
        assert len(exported(service, analysed, kind)) > 1000


def test_a_faster_walk_is_predicted_from_the_analysis(service, analysed):
    predicted = order(service, kind="predict", result_id=analysed[0]["id"], changes=[f"speed={FASTER - 1:+.0%}"])
    assert predicted["converged"] and predicted["summary"]["changes"] == ["speed=+5%"]
    assert any(file["name"].endswith("walk.npz") for file in predicted["files"])


def test_a_report_becomes_a_pdf_and_a_page(service, analysed):
    made = service.post("reports", {"kind": "report", "result_id": analysed[0]["id"]})
    result_of(service, made["content"]["job_id"])
    # Nobody has looked at the report yet.
    assert exported(service, analysed, "pdf").startswith(b"%PDF-")
    assert fetch(service, f"reports/{made['id']}/file.pdf").startswith(b"%PDF-")


def test_results_are_compared_and_become_norms(service, analysed):
    member = {"result_id": analysed[0]["id"]}
    compared = order(service, kind="compare", members=[{**member, "group": "before"}])
    names = {file["name"] for file in compared["files"]}
    assert compared["summary"]["members"] == 1 and {name.rpartition(".")[2] for name in names} >= {"csv", "svg"}
    # Norms are of at least two people.
    other = order(service, kind="analyse", session_id=service.make_visit(), settings={"weights": False})
    cohort = service.post("cohorts", {"name": "own", "members": [member, {"result_id": other["id"]}]})
    norms = order(service, kind="norms", cohort_id=cohort["id"], name="own laboratory")
    (file,) = [file["name"] for file in norms["files"] if file["name"].endswith("norms.json")]
    assert json.loads(fetch(service, f"results/{norms['id']}/files/{file}"))["name"] == "own laboratory"
