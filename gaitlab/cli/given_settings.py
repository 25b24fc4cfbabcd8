"""Settings of the commands of the server."""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from ..errors import OutputError
from ..storage.settings import Settings


def settings_of(given: Mapping[str, Any]) -> Settings:
    """Settings from the environment, and from the command line where something is given there."""
    try:
        return Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        problems = [f"{'.'.join(map(str, each['loc']))}: {each['msg']}" for each in error.errors()]
        raise OutputError(f"the settings cannot be used: {'; '.join(problems)}") from error
