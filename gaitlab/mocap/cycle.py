"""One gait cycle, apart from how cycles are found: documents that only describe one need no filters."""

from dataclasses import dataclass

from gaitlab.mocap.recording import Side


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """One stride of one side. Times [s] from the first stored frame; None where the event is not known."""

    side: Side
    start: float
    """Foot strike."""
    end: float
    """Next foot strike of the same side."""
    foot_off: float | None
    opposite_foot_off: float | None
    opposite_foot_strike: float | None

    @property
    def duration(self) -> float:
        """Stride time [s]."""
        return self.end - self.start
