"""Lists in parts, and how little work the database has with the pages that everybody looks at."""

from contextlib import contextmanager

import pytest
from sqlalchemy import event, select

from gaitlab.api import visibility
from gaitlab.api.listing import Listing
from gaitlab.storage.models import Patient, Role

PAGES = {
    "/api/v1/patients?limit=500": 3,
    "/api/v1/patients/{patient_id}": 4,
    "/api/v1/patients/{patient_id}/sessions": 4,
    "/api/v1/results?session_id={session_id}": 3,
    "/api/v1/results/{result_id}": 5,
    "/api/v1/results/{result_id}/document": 4,
}
"""Statements: who asks, what they see, the audit line; besides beginning and commit."""


@contextmanager
def statements(world):
    """Texts of what the database is asked inside the block."""
    engine, texts = world.services.database.engine, []

    def note(connection, cursor, text, *rest):
        texts.append(text)

    event.listen(engine, "before_cursor_execute", note)
    try:
        yield texts
    finally:
        event.remove(engine, "before_cursor_execute", note)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_takes_few_statements(world, page):
    path, asker = page.format(**world.case.ids), world.as_role(Role.CLINICIAN)
    world.client.get(path, headers=asker).raise_for_status()  # Writes down when the token was used, once a minute.
    with statements(world) as texts:
        world.client.get(path, headers=asker).raise_for_status()
    assert len(texts) == PAGES[page] and sum("INSERT INTO audit_log" in text for text in texts) == 1


def test_parts_are_counted_only_when_more_may_follow(world, case):
    asker = world.as_role(Role.CLINICIAN)
    whole = world.client.get("/api/v1/patients", params={"limit": 500}, headers=asker).json()
    with statements(world) as texts:
        first = world.client.get("/api/v1/patients", params={"limit": 1}, headers=asker).json()
    assert first["items"] == whole["items"][:1] and first["total"] == whole["total"] == len(whole["items"])
    assert sum("count(*) AS count_1" in text for text in texts) == 1


def test_a_listing_makes_its_statements_once():
    listing = Listing(select(Patient).order_by(Patient.id))
    assert listing.part is listing.part and listing.count is listing.count


def test_the_same_statement_serves_every_caller(world):
    strange = world.stranger.headers
    path = f"/api/v1/patients/{world.case.patient_id}"
    seen = [world.client.get(path, headers=who).status_code for who in (world.as_role(Role.CLINICIAN), strange)]
    assert seen == [200, 404]
    assert "caller_id" in str(visibility.visible(sees_all=False)) and "caller_id" not in str(visibility.visible(True))


@pytest.mark.parametrize(
    "given", [{"search": "Jane"}, {"search": "P-", "order": "-last_visit"}, {"order": "created_at"}]
)
def test_names_are_searched_by_those_who_see_them(world, given):
    def total(role):
        answer = world.client.get("/api/v1/patients", params=given | {"limit": 500}, headers=world.as_role(role))
        return answer.raise_for_status().json()["total"]

    assert (total(Role.RESEARCHER) == 0) == (given.get("search") == "Jane") and total(Role.CLINICIAN) > 0
