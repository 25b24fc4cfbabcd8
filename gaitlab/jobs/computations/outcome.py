"""What all computations share: how they end, and how they read their work."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import msgspec

from ...errors import ProblemError
from ...pipelines.progress import Progress
from ..request import Work

Settings = TypeVar("Settings")


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """How a computation ended; its files are in the folder."""

    converged: bool = True
    message: str = ""
    """What did not converge, in words."""
    summary: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """A few numbers for lists."""


Computation = Callable[[Work, Progress], Outcome]


def settings_of(work: Work, kind: type[Settings]) -> Settings:
    """The settings as the pipeline's dataclass; entries that it does not know are ignored.

    Raises:
        ProblemError: A value has the wrong type.
    """
    try:
        return msgspec.convert(dict(work.settings), kind)
    except msgspec.ValidationError as error:
        raise ProblemError(f"the settings of the job {work.kind} cannot be used: {error}") from error
