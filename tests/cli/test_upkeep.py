"""The commands of an operator, on a database of their own: backup, restore, retention, a patient's zip, a key."""

import json
import zipfile
from datetime import date

import pytest
from sqlalchemy import func, select, update
from stored import database, empty_database, make_visit

from gaitlab.storage.files import open_store
from gaitlab.storage.models import AuditEntry, GaitSession, Patient, PatientIdentity, Recording
from gaitlab.storage.settings import Settings

__all__ = ["database", "empty_database"]
NAME = "Jane Doe"


@pytest.fixture
def place(database, tmp_path):
    """Options that name an installation with one patient."""
    store = open_store(Settings(data_dir=tmp_path / "data"))
    visit = make_visit(database, store)
    with database.transaction() as session:
        session.add(PatientIdentity(patient_id=visit.patient_id, name=NAME))
    return "--data-dir", tmp_path / "data", "--database-url", database.url


def test_a_backup_is_restored_into_an_encrypted_installation(gaitlab, place, empty_database, tmp_path):
    archive, key, new = tmp_path / "backup.tar", tmp_path / "key", tmp_path / "new"
    code, out, _ = gaitlab("backup", archive, *place)
    assert code == 0 and "1 files" in out
    assert gaitlab("key", key)[0] == 0 and key.stat().st_mode & 0o077 == 0
    target = ("--data-dir", new, "--database-url", empty_database.url, "--key-file", key)
    code, out, err = gaitlab("restore", archive, *target)
    assert (code, err) == (0, "") and "1 files" in out
    with empty_database.sessions() as session:
        assert session.scalars(select(PatientIdentity.name)).one() == NAME
        digest = session.scalars(select(Recording.sha256)).one()
    assert open_store(Settings(data_dir=new, key_file=key)).read(digest) == b"walk"
    code, _, err = gaitlab("restore", archive, *target)
    assert code == 2 and "not empty" in err and len(err.splitlines()) == 1


def test_a_key_is_never_overwritten(gaitlab, tmp_path):
    assert gaitlab("key", tmp_path / "key")[0] == 0
    before = (tmp_path / "key").read_bytes()
    assert gaitlab("key", tmp_path / "key")[0] == 2
    assert (tmp_path / "key").read_bytes() == before


def test_retention_is_shown_changed_and_applied(gaitlab, place, database):
    code, out, _ = gaitlab("retention", *place)
    assert code == 0 and "for ever" in out
    with database.transaction() as session:
        session.execute(update(GaitSession).values(visited_on=date(2000, 1, 1)))
    code, out, _ = gaitlab("retention", "--keep", "patients=3650", "--keep", "web_sessions=7", *place)
    assert code == 0 and "3650" in out and "for ever" not in out
    with database.sessions() as session:
        assert session.scalar(select(func.count()).select_from(Patient)) == 1
    code, out, _ = gaitlab("retention", "--now", *place)
    assert code == 0 and "removed: 1 patients" in out
    with database.sessions() as session:
        assert session.scalar(select(func.count()).select_from(Patient)) == 0
        lines = session.scalars(select(AuditEntry.object_id).where(AuditEntry.kind == "retention_rules"))
        assert sorted(lines) == ["patients", "web_sessions"]
    assert "for ever" in gaitlab("retention", "--keep", "patients=default", *place)[1]


@pytest.mark.parametrize(("rule", "why"), [("patients", "SUBJECT=DAYS"), ("patients=-1", "is no rule"), ("x=1", "x")])
def test_a_rule_that_is_none_changes_nothing(gaitlab, place, rule, why):
    code, _, err = gaitlab("retention", "--keep", "patients=5", "--keep", rule, *place)
    assert code == 2 and why in err
    assert "for ever" in gaitlab("retention", *place)[1]


def test_everything_about_a_patient_becomes_a_zip_and_a_line_in_the_log(gaitlab, place, database, tmp_path):
    target = tmp_path / "patient.zip"
    code, out, _ = gaitlab("export-patient", "P001", target, *place)
    assert code == 0 and NAME not in out
    assert target.stat().st_mode & 0o077 == 0
    with zipfile.ZipFile(target) as archive:
        rows = json.loads(archive.read("patient.json"))
        contents = [archive.read(name) for name in archive.namelist() if name != "patient.json"]
    assert (rows["patient_identities"][0]["name"], contents) == (NAME, [b"walk"])
    with database.sessions() as session:
        line = session.scalars(select(AuditEntry).where(AuditEntry.action == "export")).one()
    assert (line.login, str(line.patient_id)) == ("gaitlab", rows["patients"][0]["id"])
    code, _, err = gaitlab("export-patient", "P001", target, *place)
    assert code == 2 and "exists" in err
    code, _, err = gaitlab("export-patient", rows["patients"][0]["id"], tmp_path / "by-id.zip", *place)
    assert code == 0


def test_an_unknown_patient_leaves_no_file(gaitlab, place, tmp_path):
    code, _, err = gaitlab("export-patient", "P999", tmp_path / "patient.zip", *place)
    assert code == 2 and "P999" in err
    assert not list(tmp_path.glob("*patient.zip*"))
