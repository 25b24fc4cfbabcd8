"""Two people who edit the same row."""

import pytest

from gaitlab.errors import Conflict
from gaitlab.storage.editing import assign, check_version, conflicts
from gaitlab.storage.models import Patient
from gaitlab.storage.schema import now


def add_patient(database, pseudonym="P001"):
    with database.transaction() as session:
        patient = Patient(pseudonym=pseudonym)
        session.add(patient)
    return patient.id


def test_a_change_of_an_old_version_is_refused_with_the_present_one(database):
    number = add_patient(database)
    with database.transaction() as session:
        session.get(Patient, number).notes = "changed"
    with database.transaction() as session, pytest.raises(Conflict, match="load it again") as refused:
        check_version(session.get(Patient, number), 1)
    assert refused.value.current == 2


def test_two_changes_at_the_same_time_do_not_overwrite_each_other(database):
    number = add_patient(database)
    with database.sessions() as first, database.sessions() as second:
        mine, theirs = first.get(Patient, number), second.get(Patient, number)
        mine.notes = "mine"
        first.commit()
        with pytest.raises(Conflict), conflicts(second, "taken"):
            theirs.notes = "theirs"
    with database.sessions() as session:
        assert session.get(Patient, number).notes == "mine"


def test_a_value_that_is_taken_is_said_in_a_sentence(database):
    add_patient(database)
    with (
        database.sessions() as session,
        pytest.raises(Conflict, match="P001 exists"),
        conflicts(session, "P001 exists"),
    ):
        session.add(Patient(pseudonym="P001"))


def test_none_leaves_a_value_unless_it_may_be_cleared():
    patient = Patient(pseudonym="P1", diagnosis="spastic", retain_until=now().date())
    assign(patient, {"diagnosis": None, "sex": "female", "retain_until": None}, frozenset({"retain_until"}))
    assert (patient.diagnosis, patient.sex, patient.retain_until) == ("spastic", "female", None)
