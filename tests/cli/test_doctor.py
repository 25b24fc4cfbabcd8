"""`gaitlab doctor` on a database of its own."""

import pytest
from stored import database, make_visit

from gaitlab.cli.doctor import examine
from gaitlab.storage.files import open_store
from gaitlab.storage.settings import Settings

__all__ = ["database"]


@pytest.fixture
def settings(database, tmp_path):
    return Settings(data_dir=tmp_path / "data", database_url=database.url)


def findings(settings):
    return {each.subject: each for each in examine(settings, verify=True)}


def test_an_installation_in_order(database, settings):
    found = findings(settings)
    assert (found["tables"].text, found["files"].well) == ("form 0001", True)
    assert found["jobs"].text == "0 queued, 0 running, 0 succeeded, 0 failed, 0 cancelled"
    assert found["workers"].well and "access" not in found


def test_a_missing_content_is_found(database, settings):
    store = open_store(settings)
    visit = make_visit(database, store)
    assert findings(settings)["contents"].text == "1 files, 0 damaged or missing"
    store.delete(visit.recordings[0].sha256)
    assert not findings(settings)["contents"].well
