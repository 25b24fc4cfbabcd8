"""What this installation can do, and what it is doing."""

from dataclasses import asdict
from typing import Annotated, Any, get_args

from fastapi import Request
from sqlalchemy import func, select, text
from sqlalchemy.orm import Session

from ... import __version__
from ...clinical.document import CURVES
from ...clinical.document import schema as document_schema
from ...clinical.examination import schema as examination_schema
from ...pipelines.body_parameters import PLAUSIBLE
from ...storage.models import Job, JobStatus, Row, StoredFile
from ..caller import Call
from ..choices import DEFAULT_CRITERIA, CriterionName
from ..dependencies import allowed, services_of
from ..files import CHUNK_LIMIT
from ..orders import NORM_NAMES
from ..permissions import Permission
from ..quantities import QUANTITIES
from ..routing import api_router
from ..schemas.system import About, PredictionQuantity, SystemState

router = api_router(tag="system")
SignedIn = Annotated[Call, allowed(Permission.ACCOUNT)]
Manager = Annotated[Call, allowed(Permission.SYSTEM_READ)]
_ROWS = text(
    "SELECT relname, GREATEST(reltuples, 0)::bigint FROM pg_class "
    "WHERE relkind = 'r' AND relnamespace = 'public'::regnamespace"
)
_WORKERS = text("SELECT id, last_heartbeat FROM procrastinate_workers ORDER BY id")


@router.get("/about")
def get_about(request: Request, call: SignedIn) -> About:
    """Criteria, curves, body parameters, quantities of predictions, norms and limits."""
    del call  # Only to be signed in.
    settings = services_of(request).settings
    return About(
        version=__version__,
        criteria=sorted(get_args(CriterionName)),
        default_criteria=DEFAULT_CRITERIA,
        curves=CURVES,
        body_parameters=PLAUSIBLE,
        prediction_quantities={name: PredictionQuantity(**asdict(each)) for name, each in QUANTITIES.items()},
        norms=sorted(NORM_NAMES),
        largest_recording=settings.max_recording_bytes,
        largest_upload=settings.max_upload_bytes,
        chunk_size=CHUNK_LIMIT,
    )


@router.get("/schemas/result")
def get_result_schema() -> dict[str, Any]:
    """JSON schema of a result's document."""
    return document_schema()


@router.get("/schemas/examination")
def get_examination_schema() -> dict[str, Any]:
    """JSON schema of a visit's clinical examination."""
    return examination_schema()


@router.get("/system")
def get_system_state(request: Request, call: Manager) -> SystemState:
    """Queue, workers, and how much is stored."""
    counts = dict(call.db.execute(select(Job.status, func.count()).group_by(Job.status)).all())
    files, file_bytes = call.db.execute(
        select(func.count(), func.coalesce(func.sum(StoredFile.size), 0)).select_from(StoredFile)
    ).one()
    known = set(Row.metadata.tables)
    return SystemState(
        version=__version__,
        jobs={status: counts.get(status, 0) for status in JobStatus},
        workers=_workers(call.db),
        viewers=len(services_of(request).viewers),
        rows={name: count for name, count in call.db.execute(_ROWS) if name in known},
        database_bytes=call.db.scalar(text("SELECT pg_database_size(current_database())")) or 0,
        files=files,
        file_bytes=int(file_bytes),
    )


def _workers(db: Session) -> list[dict[str, Any]]:
    return [
        {"id": number, "last_heartbeat": None if seen is None else seen.isoformat()}
        for number, seen in db.execute(_WORKERS)
    ]
