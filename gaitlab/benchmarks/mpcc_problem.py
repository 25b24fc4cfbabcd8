"""MPCCs of collections, with what a collection says of them."""

from dataclasses import dataclass

import numpy as np

from ..nlp.mpcc import MPCC


@dataclass(frozen=True, kw_only=True)
class NamedMPCC:
    """A problem of a collection. The objective of `problem` is minimised."""

    name: str
    problem: MPCC
    w0: np.ndarray
    """Start, shape (n_w,); added variables follow those of the file."""
    sense: int
    """1 where the file minimises, -1 where it maximises: its objective is sense * f."""

    @property
    def start(self) -> np.ndarray:
        """Start with zeros for variables that the file does not have, shape (n_w,)."""
        missing = self.problem.w.numel() - self.w0.size
        return np.append(self.w0, np.zeros(missing))
