"""What all computations share: how they end, and how they read their work."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import msgspec

from ...errors import ProblemError
from ...pipelines.progress import Progress
from ..request import OWNER, Work

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
    """The settings as the pipeline's dataclass.

    Raises:
        ProblemError: A value has the wrong type, or the job knows no setting of this name: ignored, it would be missed.
    """
    known = {each.name for each in msgspec.inspect.type_info(kind).fields}
    unknown = sorted({*work.settings} - known - {OWNER})
    if unknown:
        raise ProblemError(f"the job {work.kind} has no setting {unknown[0]}; available: {', '.join(sorted(known))}")
    try:
        return msgspec.convert(dict(work.settings), kind)
    except msgspec.ValidationError as error:
        raise ProblemError(f"the settings of the job {work.kind} cannot be used: {error}") from error
