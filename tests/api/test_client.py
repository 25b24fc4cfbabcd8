"""The client of the web pages is generated from a document that must be that of the API."""

import json
from pathlib import Path

from gaitlab.cli.openapi_document import text

DOCUMENT = Path(__file__).parents[2] / "frontend" / "openapi.json"


def test_the_document_of_the_client_is_fresh():
    assert json.loads(DOCUMENT.read_text()) == json.loads(text()), (
        "the API changed: gaitlab openapi > frontend/openapi.json"
    )
