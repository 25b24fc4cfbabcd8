"""Endpoints as the framework calls them: all the work of an answer in one turn of one thread.

Left to the framework, the transaction's beginning, the endpoint, the check of its answer and the commit would each be a
turn of its own in a thread of the pool, and to change threads costs as much as a query.
"""

import inspect
from collections.abc import Callable
from functools import wraps
from http import HTTPStatus
from typing import Any, get_type_hints

from fastapi import Response
from pydantic import TypeAdapter

from .caller import Call
from .dependencies import Asking

JSON = "application/json"


def in_one_turn(endpoint: Callable[..., Any], status: int | None) -> Callable[..., Any]:
    """The endpoint with the transaction around it, which returns its answer as it will be sent.

    Args:
        endpoint: Returns what its annotation says, so nothing is checked again; without a `Call` it stays as it is.
        status: Of its answer; None: 200.
    """
    kinds = get_type_hints(endpoint)
    answer = kinds.pop("return", None)
    asks = next((name for name, kind in kinds.items() if kind is Call), None)
    if asks is None:
        return endpoint
    tells = next((name for name, kind in kinds.items() if kind is Response), None)
    body = _Body(None if answer is Response else TypeAdapter(inspect.signature(endpoint).return_annotation), status)

    @wraps(endpoint)
    def work(**values: Any) -> Response:
        asking: Asking = values[asks]
        with asking.begin() as call:
            made = body.of(endpoint(**{**values, asks: call}))
        if tells is not None:
            made.raw_headers.extend(values[tells].raw_headers)
        return made

    return work


class _Body:
    """Makes answers of what an endpoint returns."""

    def __init__(self, writer: TypeAdapter[Any] | None, status: int | None) -> None:
        self._writer, self._status = writer, int(HTTPStatus.OK if status is None else status)

    def of(self, returned: Any) -> Response:
        if self._writer is None:
            return returned
        if self._status == HTTPStatus.NO_CONTENT:
            return Response(status_code=self._status)
        return Response(self._writer.dump_json(returned), self._status, media_type=JSON)
