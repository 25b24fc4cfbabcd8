"""What may be done, and which role may do it. Routes name a permission; a token's scopes are permissions, too."""

from collections.abc import Mapping
from enum import StrEnum

from ..storage.models import Role


class Permission(StrEnum):
    """One kind of doing."""

    ACCOUNT = "account"
    """One's own password, second factor and tokens."""
    PATIENTS_READ = "patients:read"
    """Patients that are one's own or shared: pseudonym, visits, recordings, subjects."""
    PATIENTS_WRITE = "patients:write"
    IDENTITIES_READ = "identities:read"
    """Names, birth dates, original file names and files."""
    IDENTITIES_WRITE = "identities:write"
    SHARES_WRITE = "shares:write"
    ANALYSES_READ = "analyses:read"
    ANALYSES_RUN = "analyses:run"
    RESULTS_READ = "results:read"
    RESULTS_DELETE = "results:delete"
    REPORTS_READ = "reports:read"
    REPORTS_WRITE = "reports:write"
    REPORTS_SIGN = "reports:sign"
    COHORTS_READ = "cohorts:read"
    COHORTS_WRITE = "cohorts:write"
    COLLEAGUES_READ = "colleagues:read"
    USERS_MANAGE = "users:manage"
    AUDIT_READ = "audit:read"
    SYSTEM_READ = "system:read"
    SYSTEM_WRITE = "system:write"
    """Rules of retention."""


_P = Permission
_VIEWER = {
    _P.ACCOUNT,
    _P.PATIENTS_READ,
    _P.IDENTITIES_READ,
    _P.ANALYSES_READ,
    _P.RESULTS_READ,
    _P.REPORTS_READ,
    _P.COHORTS_READ,
}
_RESEARCHER = (_VIEWER - {_P.IDENTITIES_READ, _P.REPORTS_READ}) | {_P.ANALYSES_RUN, _P.COHORTS_WRITE}
_CLINICIAN = _VIEWER | {
    _P.PATIENTS_WRITE,
    _P.IDENTITIES_WRITE,
    _P.SHARES_WRITE,
    _P.ANALYSES_RUN,
    _P.RESULTS_DELETE,
    _P.REPORTS_WRITE,
    _P.REPORTS_SIGN,
    _P.COHORTS_WRITE,
    _P.COLLEAGUES_READ,
}
PERMISSIONS: Mapping[Role, frozenset[Permission]] = {
    Role.ADMIN: frozenset(Permission),
    Role.CLINICIAN: frozenset(_CLINICIAN),
    Role.RESEARCHER: frozenset(_RESEARCHER),
    Role.VIEWER: frozenset(_VIEWER),
}
