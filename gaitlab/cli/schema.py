"""`gaitlab schema`: the contract of result.json."""

import json

import typer

from ..clinical import document


def schema() -> None:
    """Print the JSON schema of result.json."""
    typer.echo(json.dumps(document.schema(), indent=2))
