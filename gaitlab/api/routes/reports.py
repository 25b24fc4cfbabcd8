"""Reports: versions, their files, signatures."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import Query, Response
from sqlalchemy import func, select

from ...errors import AccessDenied, Conflict, InvalidRequest
from ...storage.models import (
    GaitSession,
    JobStatus,
    ReportSignature,
    ReportVersion,
    User,
)
from ...storage.models import Job as JobRow
from .. import visibility
from ..authentication import check_rate, note_attempt
from ..caller import Call
from ..dependencies import ExpectedVersion, allowed, check_version, tag
from ..files import content, stream
from ..headers import DOCUMENT
from ..listing import page
from ..orders import order
from ..passwords import verify_password
from ..permissions import Permission
from ..problems import Absent
from ..repetition import RepetitionKey, once
from ..report_files import JOB, collect
from ..routing import api_router
from ..schemas.forms import Page
from ..schemas.work import NewReport, NewSignature, Report, ReportFilter, Signature

router = api_router("/reports", tag="reports")
Reader = Annotated[Call, allowed(Permission.REPORTS_READ)]
Writer = Annotated[Call, allowed(Permission.REPORTS_WRITE)]
Signer = Annotated[Call, allowed(Permission.REPORTS_SIGN)]


def _answer(call: Call, row: ReportVersion) -> Report:
    collect(call, row)
    query = select(ReportSignature, User.display_name).join(User, User.id == ReportSignature.user_id)
    rows = call.db.execute(query.where(ReportSignature.report_id == row.id).order_by(ReportSignature.created_at))
    return Report(
        id=row.id,
        created_at=row.created_at,
        version=row.version,
        session_id=row.session_id,
        number=row.number,
        result_id=row.result_id,
        content=row.content,
        has_pdf=row.pdf_sha256 is not None,
        has_html=row.html_sha256 is not None,
        signatures=[_signature(signature, name) for signature, name in rows],
    )


def _signature(row: ReportSignature, name: str) -> Signature:
    return Signature(
        id=row.id,
        created_at=row.created_at,
        user_id=row.user_id,
        display_name=name,
        meaning=row.meaning,
        document_sha256=row.document_sha256,
    )


@router.get("")
def list_reports(call: Reader, which: Annotated[ReportFilter, Query()]) -> Page[Report]:
    """Versions of reports on visible patients, newest first."""
    query = select(ReportVersion).join(GaitSession, GaitSession.id == ReportVersion.session_id)
    query = query.where(visibility.visible(call.caller.sees_all, GaitSession.patient_id))
    if which.session_id is not None:
        query = query.where(ReportVersion.session_id == which.session_id)
    call.audit("list", "report_versions")
    query = query.order_by(ReportVersion.created_at.desc(), ReportVersion.id)
    return page(call, query, which, lambda row: _answer(call, row[0]))


@router.post("", status_code=HTTPStatus.CREATED)
def create_report(call: Writer, body: NewReport, response: Response, key: RepetitionKey = None) -> Report:
    """A new version of a visit's report; a job makes its PDF and its HTML page."""

    def make() -> Report:
        result = visibility.result(call, body.result_id, "create", "report_versions")
        if result.session_id is None:
            raise Conflict("the result belongs to no visit, so there is no report of it")
        # Numbers of one visit are given one after the other.
        call.db.get_one(GaitSession, result.session_id, with_for_update=True)
        last = select(func.max(ReportVersion.number)).where(ReportVersion.session_id == result.session_id)
        number = (call.db.scalar(last) or 0) + 1
        job, _ = order(call, body)
        told = {**body.content.model_dump(mode="json"), JOB: str(job.id)}
        row = ReportVersion(
            session_id=result.session_id,
            number=number,
            result_id=result.id,
            content=told,
            created_by=call.caller.user_id,
        )
        call.db.add(row)
        call.db.flush()
        return _answer(call, row)

    answer = once(call, key, ("createReport", body), Report, make)
    tag(response, answer.version)
    return answer


@router.get("/{report_id}")
def get_report(call: Reader, report_id: UUID, response: Response) -> Report:
    """One version of a report."""
    row = visibility.part(call, ReportVersion, report_id, "read")
    answer = _answer(call, row)
    tag(response, row.version)
    return answer


@router.get("/{report_id}/file.pdf", response_class=Response, responses=content("application/pdf"))
def download_report_pdf(call: Reader, report_id: UUID) -> Response:
    """The report as PDF."""
    return _file(call, report_id, "pdf", "application/pdf")


@router.get("/{report_id}/file.html", response_class=Response, responses=content("text/html"))
def download_report_page(call: Reader, report_id: UUID) -> Response:
    """The report as one HTML page."""
    return _file(call, report_id, "html", "text/html")


def _file(call: Call, report_id: UUID, kind: str, media_type: str) -> Response:
    row = visibility.part(call, ReportVersion, report_id, "export")
    collect(call, row)
    sha256 = row.pdf_sha256 if kind == "pdf" else row.html_sha256
    if sha256 is None:
        raise Absent(f"{kind} of report", f"{report_id}{_why_not(call, row)}")
    return stream(call, sha256, media_type, f"report-{row.number}.{kind}", content_security_policy=DOCUMENT)


def _why_not(call: Call, row: ReportVersion) -> str:
    job = call.db.get(JobRow, UUID(row.content[JOB])) if JOB in row.content else None
    return "" if job is None or job.status is JobStatus.SUCCEEDED else f" (its job is {job.status})"


@router.post("/{report_id}/signatures", status_code=HTTPStatus.CREATED)
def sign_report(call: Signer, report_id: UUID, body: NewSignature) -> Report:
    """Sign a version. What was signed is never changed; a correction is a new version."""
    row = visibility.part(call, ReportVersion, report_id, "sign")
    collect(call, row)
    if row.pdf_sha256 is None:
        raise Conflict(f"the report has no PDF yet{_why_not(call, row)}: sign what can be read")
    _check_signer(call, body.password)
    call.db.add(
        ReportSignature(
            report_id=report_id, user_id=call.caller.user_id, meaning=body.meaning, document_sha256=row.pdf_sha256
        )
    )
    call.db.flush()
    return _answer(call, row)


def _check_signer(call: Call, password: str) -> None:
    """Raise InvalidRequest for a wrong password; accounts without one need a session, no token."""
    if call.caller.web_session_id is None:
        raise AccessDenied("reports are signed by people, not by programs: sign in")
    user = call.db.get_one(User, call.caller.user_id)
    if user.password_hash is None:
        return
    check_rate(call.db, user.login, call.origin.address)
    if not verify_password(password, user.password_hash)[0]:
        with call.services.database.transaction() as db:
            note_attempt(db, user.login, call.origin.address, succeeded=False)
        raise InvalidRequest("the password is wrong, so nothing was signed")


@router.delete("/{report_id}", status_code=HTTPStatus.NO_CONTENT)
def delete_report(call: Writer, report_id: UUID, expected: ExpectedVersion) -> None:
    """Delete a version that nobody has signed."""
    row = visibility.part(call, ReportVersion, report_id, "delete")
    check_version(row, expected)
    if call.db.scalars(select(ReportSignature.id).where(ReportSignature.report_id == report_id)).first():
        raise Conflict("the report is signed, so it stays")
    call.db.delete(row)
