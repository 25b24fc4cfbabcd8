"""Processor time that the hypervisor gave to other machines: on a shared one it makes the slowest answers."""

import time
from dataclasses import dataclass, field
from threading import Event, Thread
from types import TracebackType
from typing import Self

import numpy as np
import psutil

EVERY = 0.5
"""Time between two looks [s]."""
CALM = 0.02
"""Share of the processors' time that may be missing where the machine counts as calm."""


@dataclass
class Theft:
    """A context that watches; times are those of `time.perf_counter`."""

    ends: list[float] = field(default_factory=list)
    shares: list[float] = field(default_factory=list)
    _over: Event = field(default_factory=Event)

    def __enter__(self) -> Self:
        self._thread = Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()

    def _watch(self) -> None:
        before = psutil.cpu_times()
        while not self._over.wait(EVERY):
            now = psutil.cpu_times()
            spent = sum(now[:8]) - sum(before[:8])
            self.ends.append(time.perf_counter())
            self.shares.append((now.steal - before.steal) / spent if spent > 0.0 else 0.0)
            before = now

    @property
    def mean(self) -> float:
        """Share of all processors' time."""
        return float(np.mean(self.shares))

    def was_calm(self, moments: np.ndarray) -> np.ndarray:
        """Whether nothing was stolen around moments, shape (n,), nor in the second before; shape (n,)."""
        stolen = np.array(self.ends)[np.array(self.shares) > CALM]
        gaps = stolen[None, :] - moments[:, None]
        return ~np.any((gaps > -2.0 * EVERY) & (gaps < 2.0 * EVERY), axis=1)
