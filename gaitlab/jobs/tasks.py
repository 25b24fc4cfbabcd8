"""Where a computation meets the database: files out of the store, a process, its result written once."""

import asyncio
import os
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar
from uuid import UUID

import structlog
from sqlalchemy import update
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from ..errors import StorageError
from ..storage.database import Database
from ..storage.files import FileStore, Stored
from ..storage.models import Job, JobKind, JobStatus, Recording, Result, Subject
from ..storage.references import remove_unused
from ..storage.settings import Settings
from . import metrics
from .claims import Claim, beat, claim, end, requeue
from .computing_process import OUTCOME
from .request import OWNER, QUEUES, SOLVE, Work
from .results import add_result
from .supervision import PROCESS, Ended, Limits, Verdict, Watch, run_process

Value = TypeVar("Value")
RETRY_SECONDS = 1.0
"""Pause before a step is tried again when the database is away [s]."""
log = structlog.stdlib.get_logger()


class TryAgain(Exception):
    """The job waits again: its worker is leaving, or its process was lost."""


@dataclass(kw_only=True)
class Runner:
    """Runs jobs for one worker, from the main thread's event loop."""

    database: Database
    store: FileStore
    settings: Settings
    worker: str
    """Its name in the jobs' rows."""
    workspace: Path
    """Folder of the jobs' folders; see `workspace`."""
    module: str = PROCESS
    """What the computing process runs."""
    stopping: bool = False
    """Once true, running processes are ended and their jobs wait again."""
    running: set[UUID] = field(default_factory=set[UUID])

    async def run(self, job_id: UUID) -> None:
        """Do one job, unless it is over.

        Raises:
            TryAgain: The queue has to give it out again.
        """
        claimed = await self._persistently(lambda session: claim(session, job_id, self.worker))
        if claimed is None:
            return
        with structlog.contextvars.bound_contextvars(job_id=str(job_id), attempt=claimed.attempt):
            if claimed.cancelled:
                await self._end(claimed, JobStatus.CANCELLED)
            elif claimed.losses >= self.settings.attempts:
                failure = {"kind": "lost", "losses": claimed.losses}
                await self._end(claimed, JobStatus.FAILED, _lost_sentence(claimed.losses), failure)
            else:
                self.running.add(job_id)
                try:
                    await self._compute(claimed)
                finally:
                    self.running.discard(job_id)

    async def _compute(self, claimed: Claim) -> None:
        folder = Path(tempfile.mkdtemp(dir=self.workspace, prefix=f"{claimed.job_id.hex[:8]}-"))
        try:
            job = await self._persistently(lambda session: session.get(Job, claimed.job_id))
            if job is None:
                return
            log.info("job starts", kind=job.kind.value, request_id=job.request_id)
            work = Work(kind=job.kind.value, settings=job.settings, inputs=tuple(job.inputs), folder=folder)
            try:
                await asyncio.to_thread(_lay_out, self.store, work)
            except StorageError as error:
                await self._end(claimed, JobStatus.FAILED, str(error), {"kind": "storage"})
                return
            await self._conclude(claimed, job, work, await self._process(claimed, work))
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    async def _process(self, claimed: Claim, work: Work) -> Ended:
        latest: list[Mapping[str, Any]] = []

        async def ask() -> Verdict:
            if self.stopping:
                return Verdict.SHUTDOWN
            progress = latest.pop() if latest else None
            latest.clear()
            try:
                return await asyncio.to_thread(self._once, lambda session: beat(session, claimed, progress))
            except DBAPIError as error:
                log.warning("no heartbeat: the database is away", reason=type(error.orig).__name__)
                return Verdict.GO_ON

        # Long computations step back behind the web server and the look into uploads.
        niceness = self.settings.job_niceness if QUEUES[JobKind(work.kind)] == SOLVE else 0
        settings = self.settings
        limits = Limits(seconds=settings.job_seconds, memory=settings.job_memory, niceness=niceness)
        return await run_process(work, limits, Watch(progress=latest.append, ask=ask), self.module)

    async def _conclude(self, claimed: Claim, job: Job, work: Work, ended: Ended) -> None:
        log.info("process ended", verdict=ended.verdict.value, code=ended.code, seconds=round(ended.seconds, 3))
        metrics.PROCESS_SECONDS.labels(job.kind.value).observe(ended.seconds)
        if ended.verdict is Verdict.CANCEL:
            await self._end(claimed, JobStatus.CANCELLED)
        elif ended.verdict is Verdict.SHUTDOWN:
            await self._wait_again(claimed, None, lost=False)
        elif ended.verdict is Verdict.TIME_OUT:
            sentence = f"no end within {self.settings.job_seconds:g} s; the job was stopped"
            await self._end(claimed, JobStatus.FAILED, sentence, _failure("time_out", ended))
        elif ended.verdict is Verdict.GO_ON:
            await self._finished(claimed, job, work, ended)

    async def _finished(self, claimed: Claim, job: Job, work: Work, ended: Ended) -> None:
        if ended.outcome is None and ended.signal and claimed.losses + 1 < self.settings.attempts:
            await self._wait_again(claimed, _failure("crash", ended), lost=True)
        elif ended.outcome is None:
            sentence = f"the computing process crashed ({ended.signal or f'code {ended.code}'})"
            await self._end(claimed, JobStatus.FAILED, sentence, _failure("crash", ended))
        elif "error" in ended.outcome:
            failure = {"kind": "refused", "error": ended.outcome["error_kind"]}
            await self._end(claimed, JobStatus.FAILED, ended.outcome["error"], failure)
        else:
            await self._keep((claimed, job, ended), work.out)

    async def _keep(self, done: tuple[Claim, Job, Ended], out: Path) -> None:
        """Store the files, then write the result; what a superseded attempt has stored is removed again."""
        claimed, job, _ = done
        try:
            stored, written = await self._store_and_write(done, out)
        except StorageError:
            # Somebody may have removed an equal content in between: once more.
            try:
                stored, written = await self._store_and_write(done, out)
            except StorageError as error:
                await self._end(claimed, JobStatus.FAILED, str(error), {"kind": "storage"})
                return
        if written:
            metrics.JOBS.labels(job.kind.value, JobStatus.SUCCEEDED.value).inc()
        else:
            digests = [each.sha256 for each in stored.values()]
            await asyncio.to_thread(remove_unused, self.database, self.store, digests)

    async def _store_and_write(self, done: tuple[Claim, Job, Ended], out: Path) -> tuple[dict[str, Stored], bool]:
        stored = await asyncio.to_thread(_keep_files, self.store, out)
        return stored, await self._persistently(lambda session: self._write(session, done, stored))

    def _write(self, session: Session, done: tuple[Claim, Job, Ended], files: Mapping[str, Stored]) -> bool:
        """The result, its files and the end of the job in one transaction; False if the attempt was superseded."""
        claimed, job, ended = done
        outcome = ended.outcome or {}
        if not end(session, claimed, JobStatus.SUCCEEDED):
            return False
        result = Result(
            job_id=job.id,
            kind=job.kind,
            session_id=job.session_id,
            attempt=claimed.attempt,
            converged=outcome["converged"],
            message=outcome["message"],
            summary=outcome["summary"],
            provenance=self._provenance(claimed, job, ended),
        )
        add_result(session, self.store, result, files)
        _tell_owner(session, job, outcome, files)
        return True

    def _provenance(self, claimed: Claim, job: Job, ended: Ended) -> dict[str, Any]:
        return {
            "environment": dict((ended.outcome or {})["environment"]),
            "inputs": job.inputs,
            "settings": job.settings,
            "seed": job.settings.get("seed"),
            "machine": os.uname().nodename,
            "worker": self.worker,
            "attempt": claimed.attempt,
            "seconds": round(ended.seconds, 3),
        }

    async def _end(
        self, claimed: Claim, status: JobStatus, error: str = "", failure: Mapping[str, Any] | None = None
    ) -> None:
        log.info("job ends", status=status.value, failure=(failure or {}).get("kind"))
        job = await self._persistently(
            lambda session: end(session, claimed, status, error, failure) and session.get(Job, claimed.job_id)
        )
        if job:
            metrics.JOBS.labels(job.kind.value, status.value).inc()

    async def _wait_again(self, claimed: Claim, failure: Mapping[str, Any] | None, lost: bool) -> None:
        log.info("job waits again", lost=lost)
        if await self._persistently(lambda session: requeue(session, claimed, failure, lost)):
            raise TryAgain

    async def _persistently(self, step: Callable[[Session], Value]) -> Value:
        """Do a step in a transaction of its own, again and again while the database is away."""
        while True:
            try:
                return await asyncio.to_thread(self._once, step)
            except DBAPIError as error:
                if not error.connection_invalidated and not _is_away(error):
                    raise
                log.warning("waiting for the database", reason=type(error.orig).__name__)
                await asyncio.sleep(RETRY_SECONDS)

    def _once(self, step: Callable[[Session], Value]) -> Value:
        with self.database.transaction() as session:
            return step(session)


def _is_away(error: DBAPIError) -> bool:
    # 57P0x: shut down or starting; 08xxx: connection; None: it broke before the server said anything.
    state: str | None = getattr(error.orig, "sqlstate", None)
    return state is None or state.startswith(("57P", "08", "53"))


def _lost_sentence(losses: int) -> str:
    return f"the job lost its process or its worker {losses} times and is not tried again"


def _failure(kind: str, ended: Ended) -> dict[str, Any]:
    return {
        "kind": kind,
        "signal": ended.signal,
        "code": ended.code,
        "seconds": round(ended.seconds, 3),
        "stderr": ended.stderr,
    }


def _lay_out(store: FileStore, work: Work) -> None:
    """Put the inputs, verified, into the job's folder."""
    for each in work.inputs:
        path = work.folder / "inputs" / each["name"]
        path.parent.mkdir(parents=True, exist_ok=True)
        store.copy_to(each["sha256"], path)
    work.out.mkdir()


def _keep_files(store: FileStore, out: Path) -> dict[str, Stored]:
    """Put everything in the folder of results into the store; by path with /."""
    paths = [path for path in sorted(out.rglob("*")) if path.is_file() and not path.is_symlink()]
    return {path.relative_to(out).as_posix(): store.put_file(path) for path in paths if path.name != OUTCOME}


def _tell_owner(session: Session, job: Job, outcome: Mapping[str, Any], files: Mapping[str, Stored]) -> None:
    """Write what a recording or a body model gains from the job into its row."""
    if job.kind is JobKind.INSPECT:
        summary = outcome["summary"]
        session.execute(
            update(Recording)
            .where(Recording.id == UUID(job.inputs[0]["source"]))
            .values(
                inspection={"rows": summary["rows"]},
                personal_entries=summary["personal_entries"],
                version=Recording.version + 1,
            )
        )
    model = next((files[name] for name in sorted(files) if Path(name).name == "model.urdf"), None)
    if model is not None and OWNER in job.settings:
        # Other measurements than those of the row, or changed ones since, make another body.
        session.execute(
            update(Subject)
            .where(Subject.id == UUID(job.settings[OWNER]), Subject.parameters == job.settings["parameters"])
            .values(model_sha256=model.sha256, version=Subject.version + 1)
        )
