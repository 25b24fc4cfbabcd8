"""What every answer says to browsers about security, and a 3D session that nobody looks at."""

import pytest
from web_world import running_world

from gaitlab.api.headers import PAGES
from gaitlab.storage.models import Role


@pytest.fixture(scope="module")
def clinic(tmp_path_factory):
    """With pages, behind a proxy that speaks TLS, and with little patience for 3D sessions."""
    folder = tmp_path_factory.mktemp("headers")
    (folder / "pages").mkdir()
    (folder / "pages" / "index.html").write_text("<!doctype html><title>gaitlab</title>")
    settings = {"public_url": "https://gait.example", "viewer_idle_minutes": 0.02}
    with running_world(folder, folder / "pages", **settings) as world:
        yield world


@pytest.mark.parametrize("path", ["/", "/patients/1", "/api/v1/patients", "/api/v1/none", "/health/live"])
def test_every_answer_keeps_strangers_out_of_its_page(clinic, path):
    headers = clinic.client.get(path).headers
    assert headers["content-security-policy"] == PAGES and "script-src 'self';" in PAGES
    assert (headers["x-frame-options"], headers["x-content-type-options"]) == ("DENY", "nosniff")
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-opener-policy"] == headers["cross-origin-resource-policy"] == "same-origin"
    assert "max-age=" in headers["strict-transport-security"]


def test_answers_of_the_api_stay_out_of_shared_caches(clinic):
    clinician = clinic.as_role(Role.CLINICIAN)
    for path in ("patients", f"recordings/{clinic.case.recording_id}/file", "auth/session"):
        told = clinic.client.get(f"/api/v1/{path}", headers=clinician).headers["cache-control"]
        assert "private" in told or "no-store" in told


def test_a_3d_session_that_nobody_looks_at_is_closed(clinic):
    clinician = clinic.people[Role.CLINICIAN]
    opened = clinic.client.post(f"/api/v1/results/{clinic.case.result_id}/viewer", headers=clinician.headers).json()
    address = f"/api/v1/viewers/{opened['id']}"
    assert clinic.client.get(address, headers=clinician.headers).status_code == 200
    viewer = next(iter(clinic.services.viewers._running.values()))
    clinic.wait_until(lambda: clinic.services.viewers.count_of(clinician.id) == 0)
    assert clinic.client.get(address, headers=clinician.headers).status_code == 404
    clinic.wait_until(lambda: viewer.process.returncode is not None and not viewer.folder.exists())
