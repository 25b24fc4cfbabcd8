"""Exceptions raised by gaitlab.

* GaitlabError
  + ProblemError        a problem is malformed: wrong shape, unknown name, empty grid
  + InvalidRecording    a recording cannot be used: no markers, too short, unreadable
  + InvalidSubject      body measurements are missing or impossible
  + InvalidReference    reference data (norms, a basis of scores) cannot be used
  + NotConverged        a computation that was asked for did not reach its certificate
  + Cancelled           the caller asked to stop
  + WorkerLost          a process that computed for us ended without a result
  + OutputError         a result cannot be written
  + NotFound            no stored object has this identifier
  + StorageError        the database or the file store cannot be used
  + Conflict            somebody else changed the object meanwhile, or it is used elsewhere
  + AccessDenied        the caller may not do this
    - NotSignedIn       nobody is signed in, or the credentials are wrong
      . SecondFactorMissing  the password was right, the code of the authenticator is still to come
    - TooManyAttempts   too often in too short a time; carries when to try again
  + InvalidRequest      what a client sent cannot be used: too large, out of place, malformed
    - TooLarge          more bytes than the limit
"""

from collections.abc import Iterable


class GaitlabError(Exception):
    """Base class of all exceptions raised on purpose by gaitlab."""


class ProblemError(GaitlabError):
    """An optimisation problem is malformed."""


class InvalidRecording(GaitlabError):
    """A recording cannot be analysed."""


class InvalidSubject(GaitlabError):
    """Body measurements are missing or impossible."""


class InvalidReference(GaitlabError):
    """Reference data cannot be used."""


class NotConverged(GaitlabError):
    """A computation did not reach its certificate."""


class Cancelled(GaitlabError):
    """The caller asked to stop."""


class WorkerLost(GaitlabError):
    """A computing process ended without a result."""


class OutputError(GaitlabError):
    """A result cannot be written."""


class StorageError(GaitlabError):
    """The database or the file store cannot be used, or a stored file is not what it was."""


class Conflict(GaitlabError):
    """A change that does not fit the present state of what is stored."""

    def __init__(self, sentence: str, current: int | None = None) -> None:
        super().__init__(sentence)
        self.current = current
        """Version that the object has now; None where the conflict is not about versions."""


class NotFound(GaitlabError):
    """No object has the requested name."""

    def __init__(self, kind: str, name: str, available: Iterable[str]) -> None:
        known = ", ".join(sorted(available)) or "none"
        super().__init__(f"{kind} '{name}' does not exist; available: {known}")


class AccessDenied(GaitlabError):
    """The caller may not do this."""


class NotSignedIn(AccessDenied):
    """Nobody is signed in, or the credentials are wrong."""


class SecondFactorMissing(NotSignedIn):
    """The password was right, the code of the authenticator is still to come."""


class TooManyAttempts(AccessDenied):
    """Something was tried too often."""

    def __init__(self, message: str, seconds: float) -> None:
        super().__init__(message)
        self.seconds = seconds
        """Time until it may be tried again [s]."""


class InvalidRequest(GaitlabError):
    """What a client sent cannot be used."""


class TooLarge(InvalidRequest):
    """A client sent more bytes than the limit."""
