"""Where the playback stands: a value that is replaced, never changed, so that time is testable without a clock."""

from dataclasses import dataclass, replace

import numpy as np

SPEEDS = {"0.1 x": 0.1, "0.25 x": 0.25, "0.5 x": 0.5, "1 x": 1.0}


@dataclass(frozen=True, kw_only=True)
class Playback:
    """A position on the time axis of a recording, and how it moves."""

    start: float
    """Time of the first frame [s]."""
    end: float
    """Time of the last frame [s]."""
    time: float
    """Shown time [s], from `start` to `end`."""
    speed: float = 1.0
    """Recorded seconds per second of the viewer's clock."""
    playing: bool = False

    def advanced(self, elapsed: float) -> "Playback":
        """Position after `elapsed` seconds of the viewer's clock; past the end it starts again."""
        length = self.end - self.start
        if not self.playing or length <= 0.0:
            return self
        return replace(self, time=self.start + (self.time - self.start + elapsed * self.speed) % length)

    def moved_to(self, time: float) -> "Playback":
        """Position at `time` [s], or at the nearer end."""
        return replace(self, time=min(max(time, self.start), self.end))


def playback_of(time: np.ndarray) -> Playback:
    """Stopped at the first frame of a recording with times [s], shape (n,)."""
    return Playback(start=float(time[0]), end=float(time[-1]), time=float(time[0]))


def frame_at(time: np.ndarray, moment: float) -> int:
    """Index of the frame nearest to `moment` [s]; `time` [s], shape (n,), ascending."""
    after = int(np.clip(np.searchsorted(time, moment), 1, max(len(time) - 1, 1)))
    if len(time) == 1:
        return 0
    return after if time[after] - moment < moment - time[after - 1] else after - 1
