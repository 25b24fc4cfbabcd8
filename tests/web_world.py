"""A small clinic behind the web application: users of every role, and patients with everything a route may ask for."""

import itertools
import json
import socket
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from uuid import UUID, uuid4

import httpx
import uvicorn
from stored import new_database, template, url_of
from synthetic_output import document, walk_arrays, write_output

from gaitlab.api.app import create_app
from gaitlab.api.passwords import hash_password
from gaitlab.api.permissions import Permission
from gaitlab.api.tokens import API, new_token
from gaitlab.storage.database import Database
from gaitlab.storage.files import open_store
from gaitlab.storage.models import (
    Access,
    ApiToken,
    Attachment,
    Cohort,
    CohortMember,
    GaitSession,
    Job,
    JobKind,
    JobPatient,
    JobStatus,
    Patient,
    PatientIdentity,
    PatientShare,
    Recording,
    RecordingKind,
    ReportVersion,
    Result,
    ResultFile,
    Role,
    Subject,
    Upload,
    User,
)
from gaitlab.storage.references import refer
from gaitlab.storage.settings import Settings

PASSWORD = "a long enough password"
DEMO = Path(__file__).parents[1] / "data" / "demo_able_bodied_child"
_numbers = itertools.count(1)


@dataclass(kw_only=True)
class Account:
    """A user with a token for everything."""

    id: UUID
    login: str
    token: str

    @property
    def headers(self):
        return {"Authorization": f"Bearer {self.token}"}


@dataclass(kw_only=True)
class Case:
    """Identifiers of a patient and of all that belongs to them, under the names of the routes' parameters."""

    ids: dict[str, str] = field(default_factory=dict)

    def __getattr__(self, name):
        return self.ids[name]


class World:
    """The running application and its users."""

    def __init__(self, app, client):
        self.app, self.client = app, client
        self.services = app.state.services
        self.hash = hash_password(PASSWORD)
        self.output = write_output(
            Path(tempfile.mkdtemp(dir=self.services.settings.data_dir)), document(), walk_arrays()
        )
        self.kept, self.browsers = {}, []
        self.people = {role: self.account(role) for role in Role}
        self.stranger = self.account(Role.CLINICIAN)
        self.case = self.make_case()

    def account(self, role, db=None):
        """A new user of this role."""
        if db is None:
            with self.services.database.transaction() as opened:
                return self.account(role, opened)
        number, (text, digest) = next(_numbers), new_token(API)
        user = User(login=f"user{number}@clinic.example", display_name=f"User {number}", role=role)
        user.password_hash = self.hash
        db.add(user)
        db.flush()
        db.add(ApiToken(user_id=user.id, name="all", token_hash=digest, scopes=[str(p) for p in Permission]))
        return Account(id=user.id, login=user.login, token=text)

    def store(self, db, content):
        """Keep a content; the same one is kept once, as files are written with care and slowly."""
        if content not in self.kept:
            stored = self.services.files.put([content])
            refer(db, self.services.files, stored)
            self.kept[content] = {"sha256": stored.sha256, "size": stored.size}
        return self.kept[content]

    def make_case(self):
        """A clinician's patient, shared with researcher and viewer for reading."""
        number, owner = next(_numbers), self.people[Role.CLINICIAN].id
        with self.services.database.transaction() as db:
            patient = Patient(pseudonym=f"P-{number:04}", created_by=owner, notes="Jane fell")
            db.add(patient)
            db.flush()
            db.add(PatientIdentity(patient_id=patient.id, name="Jane Doe", birth_date=date(2016, 5, 1)))
            for role in (Role.RESEARCHER, Role.VIEWER):
                db.add(PatientShare(patient_id=patient.id, user_id=self.people[role].id, access=Access.READ))
            ids = {"patient_id": patient.id, "user_id": self.account(Role.VIEWER, db=db).id}
            ids |= self._visit(db, patient)
            ids |= self._work(db, patient, ids, number)
        return Case(ids={name: str(value) for name, value in ids.items()})

    def _visit(self, db, patient):
        visit = GaitSession(patient_id=patient.id, visited_on=date(2026, 11, 20), notes="Jane was tired")
        db.add(visit)
        db.flush()
        content = (DEMO / "walk1.c3d").read_bytes()
        recording = Recording(
            session_id=visit.id, name="Jane_walk.c3d", kind=RecordingKind.WALK, **self.store(db, content)
        )
        subject = Subject(session_id=visit.id, parameters={"mass": 30.0})
        subject.model_sha256 = self.store(db, b"<robot/>")["sha256"]
        video = Attachment(session_id=visit.id, name="v.mp4", media_type="video/mp4", **self.store(db, bytes(5000)))
        upload = Upload(
            session_id=visit.id,
            user_id=patient.created_by,
            name="note.txt",
            size=4,
            expires_at=datetime.now(UTC) + timedelta(days=1),
        )
        db.add_all([recording, subject, video, upload])
        db.flush()
        return {
            "session_id": visit.id,
            "recording_id": recording.id,
            "subject_id": subject.id,
            "attachment_id": video.id,
            "upload_id": upload.id,
        }

    def _work(self, db, patient, ids, number):
        inputs = [{"role": "walk", "name": "Jane_walk.c3d", "sha256": "0" * 64, "source": str(ids["recording_id"])}]
        more = {"session_id": ids["session_id"], "inputs": inputs}
        done = Job(kind=JobKind.ANALYSE, input_hash=f"{number:064}", status=JobStatus.SUCCEEDED, **more)
        failed = Job(kind=JobKind.ANALYSE, input_hash=f"{number:063}f", status=JobStatus.FAILED, **more)
        waiting = Job(kind=JobKind.ANALYSE, input_hash=f"{number:063}w", **more)
        db.add_all([done, failed, waiting])
        db.flush()
        db.add_all(JobPatient(job_id=job.id, patient_id=patient.id) for job in (done, failed, waiting))
        result = self._result(db, done)
        report = ReportVersion(session_id=ids["session_id"], number=1, result_id=result.id)
        report.pdf_sha256 = self.store(db, b"%PDF-1.7")["sha256"]
        report.html_sha256 = self.store(db, b"<!DOCTYPE html><p>report")["sha256"]
        cohort = Cohort(name=f"cohort {number}", created_by=self.people[Role.CLINICIAN].id)
        db.add_all([report, cohort])
        db.flush()
        db.add(CohortMember(cohort_id=cohort.id, result_id=result.id))
        token = ApiToken(user_id=self.people[Role.ADMIN].id, name="t", token_hash=uuid4().hex * 2, scopes=["account"])
        db.add(token)
        return {
            "analysis_id": done.id,
            "failed_id": failed.id,
            "waiting_id": waiting.id,
            "result_id": result.id,
            "report_id": report.id,
            "cohort_id": cohort.id,
            "token_id": token.id,
        }

    def _result(self, db, job):
        result = Result(job_id=job.id, kind=job.kind, session_id=job.session_id, attempt=1, provenance={"gaitlab": "0"})
        db.add(result)
        db.flush()
        written = json.dumps(document("Jane_walk")).encode()
        for name, kind, content in (
            ("result.json", "application/json", written),
            ("walk.npz", "application/octet-stream", (self.output / "walk.npz").read_bytes()),
            ("angles.csv", "text/csv", (self.output / "angles.csv").read_bytes()),
            ("report.html", "text/html", b"<!DOCTYPE html><p>Jane"),
        ):
            db.add(ResultFile(result_id=result.id, name=name, media_type=kind, **self.store(db, content)))
        db.flush()
        return result

    def as_role(self, role):
        return self.people[role].headers

    def browser(self):
        """A browser of its own, in which nobody is signed in."""
        self.browsers.append(httpx.Client(base_url=self.client.base_url, timeout=60.0))
        return self.browsers[-1]

    def wait_until(self, look, seconds=30.0):
        """Wait for something that happens by itself."""
        deadline = time.monotonic() + seconds
        while not look():
            assert time.monotonic() < deadline, "it does not happen"
            time.sleep(0.05)

    def close(self):
        """Close all browsers."""
        for browser in self.browsers:
            browser.close()

    def sign_in(self, account, **more):
        """A browser of its own that is signed in; its headers hold the CSRF token."""
        browser = self.browser()
        answer = browser.post("/api/v1/auth/sign-in", json={"login": account.login, "password": PASSWORD, **more})
        assert answer.status_code == 200, answer.text
        browser.headers["X-CSRF-Token"] = answer.json()["csrf_token"]
        return browser


@contextmanager
def serving(app):
    """Address of a real server with the application, on this machine only."""
    listener = socket.create_server(("127.0.0.1", 0))
    config = uvicorn.Config(app, log_config=None, access_log=False, lifespan="on", timeout_graceful_shutdown=2)
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, args=([listener],))
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive(), "the server did not start"
            thread.join(0.05)
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()


@contextmanager
def running_world(data_dir, frontend=None, **settings):
    """The application on a database of its own, from start to end; without pages unless their folder is given."""
    url = url_of(new_database(template()))
    app = create_app(
        Settings(data_dir=data_dir, database_url=url, **settings), frontend=frontend or data_dir / "frontend"
    )
    with serving(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        world = World(app, client)
        yield world
        world.close()


@contextmanager
def world_in_a_process(data_dir):
    """As `running_world`, but the web application is a process of its own; also yields that process."""
    url = url_of(new_database(template()))
    script = Path(__file__).parent / "served_world.py"
    command = [sys.executable, str(script), str(data_dir), url]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        try:
            address = process.stdout.readline().strip()
            settings = Settings(data_dir=data_dir, database_url=url)
            services = SimpleNamespace(settings=settings, database=Database.open(url), files=open_store(settings))
            app = SimpleNamespace(state=SimpleNamespace(services=services))
            with httpx.Client(base_url=address, timeout=120.0) as client:
                world = World(app, client)
                yield world, process
                world.close()
            services.database.close()
        finally:
            process.terminate()
