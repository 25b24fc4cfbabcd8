"""Files of reports: a job makes them, a version of the report takes them over when somebody asks."""

from uuid import UUID

from sqlalchemy import select

from ..storage.models import ReportVersion, Result, ResultFile
from .caller import Call

FILES = {"pdf": "report.pdf", "html": "report.html"}
JOB = "job_id"
"""Key of a version's content: the job that makes its files."""


def collect(call: Call, row: ReportVersion) -> None:
    """Take over the files that the report's job has made meanwhile."""
    job_id = row.content.get(JOB)
    if job_id is None or row.pdf_sha256 is not None:
        return
    query = select(ResultFile.name, ResultFile.sha256).join(Result, Result.id == ResultFile.result_id)
    made = dict(call.db.execute(query.where(Result.job_id == UUID(job_id))).all())
    row.pdf_sha256, row.html_sha256 = made.get(FILES["pdf"]), made.get(FILES["html"])
    call.db.flush()


def newest_pdf(call: Call, result_id: UUID) -> str | None:
    """SHA-256 of the PDF of a result's newest report that has one."""
    query = select(ReportVersion).where(ReportVersion.result_id == result_id).order_by(ReportVersion.number.desc())
    for row in call.db.scalars(query):
        collect(call, row)
        if row.pdf_sha256 is not None:
            return row.pdf_sha256
    return None
