"""The OpenAPI document as text; needs the packages of the server, but no database."""

import json

from ..api.app import create_app
from ..storage.settings import Settings


def text() -> str:
    """Indented JSON, the same for the same version."""
    return json.dumps(create_app(Settings()).openapi(), indent=2)
