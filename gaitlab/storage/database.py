"""Connection to PostgreSQL 15 to 18."""

import select
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Self

import psycopg
from sqlalchemy import Engine, create_engine, event, make_url, text
from sqlalchemy.exc import ArgumentError, InvalidatePoolError, OperationalError
from sqlalchemy.orm import Session, sessionmaker

from ..errors import StorageError

OLDEST, NEWEST = 15, 18
"""Major versions of PostgreSQL that are tested."""


@dataclass(frozen=True, kw_only=True)
class Database:
    """An engine and its sessions."""

    url: str = field(repr=False)
    """As libpq reads it; holds the password."""
    engine: Engine = field(repr=False)
    sessions: sessionmaker[Session] = field(repr=False)

    @classmethod
    def open(cls, url: str, connections: int = 10, spare: int = 10) -> Self:
        """Make the engine; nothing is connected before the first use.

        Args:
            url: Address of the database.
            connections: How many are kept open.
            spare: How many more are opened for a peak, and closed after it; each costs the server a new process.
        """
        try:
            parts = make_url(url)
        except ArgumentError as error:
            raise StorageError(
                "the database address is not of the form postgresql://user:password@host/name"
            ) from error
        if parts.get_backend_name() != "postgresql":
            raise StorageError(f"the database is {parts.get_backend_name()}; only postgresql:// is supported")
        engine = create_engine(
            parts.set(drivername="postgresql+psycopg"),
            hide_parameters=True,
            pool_size=connections,
            max_overflow=spare,
            # The connection that was used last: its server process is warm and has the statements prepared.
            pool_use_lifo=True,
        )
        event.listen(engine, "checkout", _refuse_closed)
        plain = parts.set(drivername="postgresql").render_as_string(hide_password=False)
        return cls(url=plain, engine=engine, sessions=sessionmaker(engine, expire_on_commit=False))

    @contextmanager
    def transaction(self) -> Generator[Session]:
        """A session whose changes are committed at the end, or undone by an exception."""
        with self.sessions.begin() as session:
            yield session

    def check(self) -> int:
        """Connect and return the major version.

        Raises:
            StorageError: No connection, or a version that the queries do not run on.
        """
        try:
            with self.engine.connect() as connection:
                number = int(connection.execute(text("SHOW server_version_num")).scalar_one())
        except OperationalError as error:
            raise StorageError(f"no connection to the database: {first_line(error.orig)}") from error
        if number // 10000 < OLDEST:
            raise StorageError(f"the database is PostgreSQL {number // 10000}; {OLDEST} to {NEWEST} are supported")
        return number // 10000

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()


def _refuse_closed(connection: psycopg.Connection[Any], *pooled: object) -> None:
    """Let the pool replace its connections when the server has closed this one.

    A server that ended has said so: an idle connection has something to read, be it only the end. To look costs
    nothing, while the usual question to the server would cost each request as much as one of its queries.
    """
    del pooled  # The pool's own records.
    if connection.closed or _has_news(connection.fileno()):
        raise InvalidatePoolError


def _has_news(descriptor: int) -> bool:
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    return bool(poll.poll(0))


def first_line(error: BaseException | None) -> str:
    """First line of a driver's message: the rest may hold values."""
    return (str(error).strip().splitlines() or ["unknown reason"])[0]


def reachable(url: str, seconds: float) -> bool:
    """Whether the server answers a connection within `seconds`."""
    try:
        psycopg.connect(url, connect_timeout=max(2, round(seconds))).close()
    except psycopg.OperationalError:
        return False
    return True
