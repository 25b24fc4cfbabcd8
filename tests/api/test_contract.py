"""Random requests made from the OpenAPI document: no server error, and every answer as the document says."""

import os

import pytest
import schemathesis
from api_operations import operations_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import Unsatisfiable
from schemathesis import GenerationMode
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from gaitlab.api.app import create_app
from gaitlab.storage.models import Role
from gaitlab.storage.settings import Settings

DOCUMENT = create_app(Settings()).openapi()
CONTRACT = schemathesis.openapi.from_dict(DOCUMENT)
CHECKS = [not_a_server_error, content_type_conformance, response_schema_conformance, status_code_conformance]
ENDLESS = {"watchAnalysis", "openViewer"}
"""A stream that does not end, and processes; tests of their own."""
OPERATIONS = [f"{method} {path}" for method, path, o in operations_of(DOCUMENT) if o["operationId"] not in ENDLESS]
FEW, MANY = 3, int(os.environ.get("GAITLAB_CONTRACT_EXAMPLES", "20"))
QUIET = {"deadline": None, "database": None, "derandomize": True, "suppress_health_check": list(HealthCheck)}


@pytest.fixture(scope="module")
def tester(world):
    """An administrator of the test's own, whom random requests may sign out or close."""
    return world.account(Role.ADMIN)


def check(world, tester, label, examples):
    """Send random requests, right and wrong ones, to made-up objects and to those of a real patient."""
    method, path = label.split(" ")
    operation, known = CONTRACT[path][method], world.make_case().ids
    names = [name for name in known if f"{{{name}}}" in path]
    for mode in (GenerationMode.POSITIVE, GenerationMode.NEGATIVE):
        for real in ({}, {name: known[name] for name in names}) if names else ({},):
            try:
                send(world, tester, operation.as_strategy(mode), real, examples)
            except Unsatisfiable:
                # There is no wrong request to an operation without parameters.
                assert mode is GenerationMode.NEGATIVE and "requestBody" not in operation.definition.raw


def send(world, tester, requests, real, examples):
    base = str(world.client.base_url).rstrip("/")

    @settings(max_examples=examples, phases=[Phase.generate], **QUIET)
    @given(case=requests)
    def one(case):
        case.path_parameters = {**case.path_parameters, **real}
        case.call_and_validate(base_url=base, headers=tester.headers, checks=CHECKS, timeout=60)

    one()


@pytest.mark.parametrize("label", OPERATIONS)
def test_random_requests_get_documented_answers(world, tester, label):
    check(world, tester, label, FEW)


@pytest.mark.slow
@pytest.mark.parametrize("label", OPERATIONS)
def test_many_random_requests_get_documented_answers(world, tester, label):
    check(world, tester, label, MANY)
