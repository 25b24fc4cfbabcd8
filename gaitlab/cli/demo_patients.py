"""The demo patients in a database: an account, the recordings, the result that `gaitlab demo` has computed."""

from dataclasses import dataclass
from datetime import date
from pathlib import Path

from sqlalchemy import exists, select
from sqlalchemy.orm import Session

from ..api.passwords import hash_password
from ..jobs.imported import import_result
from ..jobs.queue import submit
from ..jobs.request import JobInput, JobRequest
from ..pipelines.bundled import DEMO_CHILDREN, demo_folder
from ..storage.database import Database
from ..storage.files import FileStore
from ..storage.models import GaitSession, JobKind, Patient, Recording, RecordingKind, Role, User
from ..storage.references import refer

PASSWORD = "gaitlab-demo"
"""Of both accounts. The demo listens on this machine only and holds simulated children."""
LOGINS = {"demo": Role.CLINICIAN, "demo-admin": Role.ADMIN}
DIAGNOSES = {"demo_cp_child": "simulated: cerebral palsy", "demo_able_bodied_child": "simulated: able-bodied"}


@dataclass(frozen=True, kw_only=True)
class Visit:
    """One demo patient's visit."""

    patient: Patient
    session: GaitSession
    recordings: tuple[Recording, ...]

    def request(self, kind: JobKind, recordings: tuple[Recording, ...], **settings: object) -> JobRequest:
        """A job on some of the recordings."""
        inspects = kind is JobKind.INSPECT
        return JobRequest(
            kind=kind,
            inputs=tuple(
                JobInput(
                    role="recording" if inspects else each.kind.value,
                    name=each.name,
                    sha256=each.sha256,
                    source=each.id,
                )
                for each in recordings
            ),
            patients=frozenset({self.patient.id}),
            session_id=self.session.id,
            settings=settings,
        )


def add_demo_patients(database: Database, store: FileStore, analysed: str, results: Path) -> bool:
    """Fill a database that nobody has an account in.

    Args:
        database: With its tables.
        store: Keeps the files.
        analysed: The child whose result is there.
        results: What `gaitlab demo` wrote.

    Returns:
        Whether it was filled; a database with accounts is left as it is.

    Raises:
        OutputError: There is no result in the folder.
    """
    with database.transaction() as session:
        if session.scalar(select(exists(User.id))):
            return False
        for login, role in LOGINS.items():
            session.add(User(login=login, display_name="Demo", role=role, password_hash=hash_password(PASSWORD)))
        session.flush()
        owner = session.scalars(select(User).where(User.role == Role.CLINICIAN)).one()
        for child in DEMO_CHILDREN:
            visit = _add_visit(session, store, child, owner)
            for recording in visit.recordings:
                submit(session, visit.request(JobKind.INSPECT, (recording,)))
            if child == analysed:
                import_result(session, store, visit.request(JobKind.ANALYSE, visit.recordings), results)
            else:
                # Its weights would keep both processors busy for minutes; a click computes them.
                submit(session, visit.request(JobKind.ANALYSE, visit.recordings, weights=False, processes=1))
    return True


def _add_visit(session: Session, store: FileStore, child: str, owner: User) -> Visit:
    pseudonym = child.removesuffix("_child").replace("_", "-").upper()
    patient = Patient(pseudonym=pseudonym, diagnosis=DIAGNOSES[child], created_by=owner.id)
    session.add(patient)
    session.flush()
    visit = GaitSession(patient_id=patient.id, visited_on=date.today(), condition="barefoot")
    session.add(visit)
    session.flush()
    recordings: list[Recording] = []
    for name in ("static.c3d", "walk1.c3d", "walk2.c3d"):
        stored = store.put_file(demo_folder(child) / name)
        refer(session, store, stored)
        kind = RecordingKind.STATIC if name.startswith("static") else RecordingKind.WALK
        recording = Recording(
            session_id=visit.id, name=name, kind=kind, sha256=stored.sha256, size=stored.size, created_by=owner.id
        )
        session.add(recording)
        session.flush()
        recordings.append(recording)
    return Visit(patient=patient, session=visit, recordings=tuple(recordings))
