"""Deleting a patient removes rows and files, and leaves one line."""

import json
import zipfile
from datetime import timedelta
from io import BytesIO
from uuid import uuid4

import pytest
from sqlalchemy import func, inspect, select, update
from stored import make_visit

from gaitlab.errors import NotFound, StorageError
from gaitlab.storage.audit import SYSTEM
from gaitlab.storage.deletion import delete_patient, delete_session
from gaitlab.storage.export import export_patient
from gaitlab.storage.models import (
    AuditEntry,
    Cohort,
    CohortMember,
    GaitSession,
    Job,
    JobKind,
    JobPatient,
    JobStatus,
    Patient,
    PatientIdentity,
    Recording,
    ReportSignature,
    ReportVersion,
    Result,
    ResultFile,
    Role,
    Row,
    StoredFile,
    Subject,
    Upload,
    UploadChunk,
    User,
)
from gaitlab.storage.references import collect_garbage, refer, remove_unused
from gaitlab.storage.retention import apply_retention, rules, set_rule
from gaitlab.storage.schema import now

KEPT = {"audit_log", "users", "cohorts", "alembic_version"}
SHARED = b"the same calibration trial"


def add_result(session, store, visit, patients, inputs, content=b"result"):
    job = Job(
        kind=JobKind.ANALYSE, input_hash=uuid4().hex * 2, session_id=visit, inputs=inputs, status=JobStatus.SUCCEEDED
    )
    session.add(job)
    session.flush()
    session.add_all(JobPatient(job_id=job.id, patient_id=patient) for patient in patients)
    result = Result(job_id=job.id, kind=job.kind, attempt=1, provenance={}, session_id=visit)
    stored = store.put([content])
    refer(session, store, stored)
    session.add(result)
    session.flush()
    file = ResultFile(
        result_id=result.id, name="result.json", media_type="application/json", sha256=stored.sha256, size=stored.size
    )
    session.add(file)
    session.flush()
    return result, stored


def fill(database, store):
    """A patient with something in every table, and the id of a user."""
    visit = make_visit(database, store, (("walk.c3d", b"walk"), ("static.c3d", SHARED)))
    with database.transaction() as session:
        user = User(login="somebody", role=Role.ADMIN)
        session.add(user)
        session.flush()
        session.add(PatientIdentity(patient_id=visit.patient_id, name="Jane Doe"))
        session.add(Subject(session_id=visit.session_id, parameters={"mass": 30.0}))
        inputs = [{"role": "walk", "source": str(visit.recordings[0].id)}]
        result, stored = add_result(session, store, visit.session_id, [visit.patient_id], inputs)
        report = ReportVersion(session_id=visit.session_id, number=1, result_id=result.id, html_sha256=stored.sha256)
        cohort = Cohort(name="able-bodied")
        session.add_all([report, cohort])
        session.flush()
        session.add(ReportSignature(report_id=report.id, user_id=user.id, document_sha256=stored.sha256))
        session.add(CohortMember(cohort_id=cohort.id, result_id=result.id))
        upload = Upload(
            session_id=visit.session_id, user_id=user.id, name="next.c3d", size=9, expires_at=now() + timedelta(hours=1)
        )
        session.add(upload)
        session.flush()
        chunk = store.put([b"chunk"])
        refer(session, store, chunk)
        session.add(UploadChunk(upload_id=upload.id, offset=0, size=5, sha256=chunk.sha256))
    return visit


def rows(database):
    """Number of rows by table, without those of the queue and of the tables that stay."""
    with database.sessions() as session:
        counts = {name: session.scalar(select(func.count()).select_from(t)) for name, t in Row.metadata.tables.items()}
    return {name: count for name, count in counts.items() if count and name not in KEPT}


def test_a_patient_goes_with_every_row_and_file(database, store):
    visit = fill(database, store)
    delete_patient(database, store, visit.patient_id, SYSTEM)
    assert rows(database) == {}
    assert list(store.names()) == []


def test_one_line_of_the_log_stays_without_the_name(database, store):
    visit = fill(database, store)
    delete_patient(database, store, visit.patient_id, SYSTEM)
    with database.sessions() as session:
        (line,) = session.scalars(select(AuditEntry).where(AuditEntry.action == "delete"))
    assert line.patient_id == visit.patient_id
    assert line.detail == {"sessions": 1, "recordings": 2, "jobs": 1}


def test_files_that_others_use_stay(database, store):
    visit = fill(database, store)
    other = make_visit(database, store, (("static.c3d", SHARED),), "P002")
    delete_patient(database, store, visit.patient_id, SYSTEM)
    assert store.read(other.recordings[0].sha256) == SHARED
    with database.sessions() as session:
        assert list(session.scalars(select(StoredFile.sha256))) == [other.recordings[0].sha256]


def test_a_comparison_with_others_goes_too(database, store):
    visit, other = fill(database, store), make_visit(database, store, pseudonym="P002")
    with database.transaction() as session:
        add_result(session, store, None, [visit.patient_id, other.patient_id], [], b"comparison")
    delete_patient(database, store, visit.patient_id, SYSTEM)
    with database.sessions() as session:
        assert session.scalar(select(func.count()).select_from(Result)) == 0
        assert session.get(Patient, other.patient_id) is not None


def test_an_analysis_of_somebody_else_with_norms_of_the_patient_stays(database, store):
    visit, other = fill(database, store), make_visit(database, store, pseudonym="P002")
    with database.transaction() as session:
        norms, _ = add_result(session, store, None, [visit.patient_id], [], b"norms")
        inputs = [{"role": "norms", "source": str(norms.id)}]
        kept, _ = add_result(session, store, other.session_id, [other.patient_id], inputs, b"kept")
    delete_patient(database, store, visit.patient_id, SYSTEM)
    with database.sessions() as session:
        assert list(session.scalars(select(Result.id))) == [kept.id]


def test_a_visit_goes_with_what_was_computed_from_its_results(database, store):
    visit = fill(database, store)
    with database.transaction() as session:
        before = session.scalars(select(Result)).one()
        inputs = [{"role": "result", "source": str(before.id)}]
        add_result(session, store, None, [visit.patient_id], inputs, b"norms")
    delete_session(database, store, visit.session_id, SYSTEM)
    assert rows(database) == {"patients": 1, "patient_identities": 1}


def test_a_report_of_another_visit_goes_with_the_result_that_it_reports_on(database, store):
    visit = fill(database, store)
    with database.transaction() as session:
        later = GaitSession(patient_id=visit.patient_id, visited_on=now().date())
        page, pdf = store.put([b"page"]), store.put([b"pdf"])
        for stored in (page, pdf):
            refer(session, store, stored)
        session.add(later)
        session.flush()
        result = session.scalars(select(Result)).one()
        report = ReportVersion(session_id=later.id, number=1, result_id=result.id)
        report.html_sha256, report.pdf_sha256 = page.sha256, pdf.sha256
        session.add(report)
    delete_session(database, store, visit.session_id, SYSTEM)
    assert rows(database) == {"patients": 1, "patient_identities": 1, "sessions": 1}
    assert list(store.names()) == []


def test_an_unknown_patient_is_said(database, store):
    with pytest.raises(NotFound, match="patient"):
        delete_patient(database, store, uuid4(), SYSTEM)


def test_a_content_removed_before_it_is_referred_to_is_sent_again(database, store):
    stored = store.put([b"walk"])
    store.delete(stored.sha256)
    with pytest.raises(StorageError, match="send it again"), database.transaction() as session:
        refer(session, store, stored)


def test_garbage_is_collected_and_nothing_else(database, store):
    visit = make_visit(database, store)
    store.put([b"nobody's, without a row"])
    with database.transaction() as session:
        refer(session, store, store.put([b"nobody's, with a row"]))
        session.execute(update(StoredFile).values(created_at=now() - timedelta(days=2)))
    assert collect_garbage(database, store) == 1
    assert collect_garbage(database, store, grace=-1.0) == 1
    assert [name for name, _ in store.names()] == [visit.recordings[0].sha256]
    assert remove_unused(database, store, [visit.recordings[0].sha256]) == 0


def test_the_export_holds_every_row_and_file_of_the_patient(database, store):
    visit = fill(database, store)
    other = make_visit(database, store, pseudonym="P002")
    with database.transaction() as session:
        add_result(session, store, None, [visit.patient_id, other.patient_id], [], b"comparison")
    target = BytesIO()
    export_patient(database, store, visit.patient_id, target)
    with zipfile.ZipFile(target) as archive:
        text = json.loads(archive.read("patient.json"))
        contents = {archive.read(name) for name in archive.namelist() if name != "patient.json"}
    assert text["patient_identities"][0]["name"] == "Jane Doe"
    assert {name: len(part) for name, part in text.items() if part} == {
        "patients": 1, "patient_identities": 1, "sessions": 1, "recordings": 2, "subjects": 1, "jobs": 1,
        "results": 1, "result_files": 1, "report_versions": 1, "report_signatures": 1,
    }  # fmt: skip
    assert contents == {b"walk", SHARED, b"result"}


def test_retention_removes_patients_after_their_last_visit(database, store):
    old, young = make_visit(database, store), make_visit(database, store, pseudonym="P002")
    kept = make_visit(database, store, pseudonym="P003")
    with database.transaction() as session:
        set_rule(session, "patients", 3650)
        table = inspect(Recording).mapper.registry.metadata.tables["sessions"]
        old_ones = table.c.id.in_([old.session_id, kept.session_id])
        session.execute(update(table).where(old_ones).values(visited_on=now().date() - timedelta(days=4000)))
        session.get(Patient, kept.patient_id).retain_until = now().date() + timedelta(days=1)
    assert apply_retention(database, store).removed["patients"] == 1
    with database.sessions() as session:
        assert set(session.scalars(select(Patient.id))) == {young.patient_id, kept.patient_id}


def test_uploads_that_were_given_up_lose_their_chunks(database, store):
    fill(database, store)
    with database.transaction() as session:
        session.execute(update(Upload).values(expires_at=now() - timedelta(seconds=1)))
    assert apply_retention(database, store).removed["uploads"] == 1
    assert "upload_chunks" not in rows(database)


def test_rules_have_names(database):
    with database.transaction() as session:
        with pytest.raises(NotFound, match="login_attempts"):
            set_rule(session, "everything", 1)
        set_rule(session, "login_attempts", 7)
        assert rules(session)["login_attempts"] == 7
        set_rule(session, "login_attempts", None)
        assert rules(session)["login_attempts"] == 30
