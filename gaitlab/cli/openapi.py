"""`gaitlab openapi`: the contract of the REST API."""

import typer

from .server_extra import load


def openapi() -> None:
    """Print the OpenAPI document of the REST API, from which clients are generated."""
    typer.echo(load("openapi_document").text())
