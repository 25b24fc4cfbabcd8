"""Which edition of a report this is: draft or signed, its number, what it amends."""

from dataclasses import dataclass

INTENDED_USE = (
    "Intended use: research tool, not a stand-alone diagnosis. The numbers describe recordings and a model; decisions "
    "about a person need a qualified clinician and further examination."
)


@dataclass(frozen=True, kw_only=True)
class Edition:
    """State of a report, as printed on every page."""

    number: int = 1
    signed_by: str = ""
    signed_at: str = ""
    """Coordinated universal time, ISO 8601."""
    amended_by: str = ""
    """Who asked for the change of the edition before; empty for a first one."""
    reason: str = ""
    """Why the edition before was amended."""

    @property
    def words(self) -> str:
        """State in words."""
        if self.signed_by:
            state = f"Version {self.number}, signed by {self.signed_by}, {self.signed_at}"
        else:
            state = f"Draft of version {self.number}, not signed"
        if self.number == 1 or not self.reason:
            return state
        return f"{state}; amends version {self.number - 1} ({self.amended_by}: {self.reason})"


DRAFT = Edition()
