"""Who asks, and what a request of theirs may reach."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Executable, Result
from sqlalchemy.orm import Session

from ..storage.audit import Actor, Deed, record
from ..storage.models import Role
from .permissions import Permission
from .services import Services


@dataclass(frozen=True, kw_only=True)
class Caller:
    """A user who is signed in, or a program with a token of theirs."""

    user_id: UUID
    login: str
    role: Role
    permissions: frozenset[Permission]
    web_session_id: UUID | None = None
    token_id: UUID | None = None

    @property
    def sees_all(self) -> bool:
        """True: the patients of everybody."""
        return self.role is Role.ADMIN

    @property
    def sees_names(self) -> bool:
        """False: pseudonyms only."""
        return Permission.IDENTITIES_READ in self.permissions


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a request came from."""

    address: str
    request_id: str

    def actor(self, caller: Caller | None) -> Actor:
        """Who acts from here, as the audit log has it; None: nobody is signed in."""
        return Actor(
            user_id=None if caller is None else caller.user_id,
            login="" if caller is None else caller.login,
            request_id=self.request_id,
            address=self.address,
        )


@dataclass(frozen=True, kw_only=True)
class Call:
    """One request with what it needs: its transaction, its caller, the services."""

    db: Session
    caller: Caller
    origin: Origin
    services: Services

    @property
    def actor(self) -> Actor:
        """Who acts, as the audit log has it."""
        return self.origin.actor(self.caller)

    def find(self, query: Executable, **values: Any) -> Result[*tuple[Any, ...]]:
        """Rows of a query, whose conditions know the caller as `caller_id` (`visibility.CALLER`)."""
        return self.db.execute(query, {"caller_id": self.caller.user_id, **values})

    def audit(
        self,
        action: str,
        kind: str,
        object_id: object = "",
        patient_id: UUID | None = None,
        detail: Mapping[str, Any] | None = None,
    ) -> None:
        """Add a line to the audit log, in the same transaction as what it tells of."""
        token = {} if self.caller.token_id is None else {"token": str(self.caller.token_id)}
        deed = Deed(
            action=action,
            kind=kind,
            object_id=str(object_id),
            patient_id=patient_id,
            detail={**(detail or {}), **token},
        )
        record(self.db, self.actor, deed)
