from report.page import Page, render
from report.test_kinetics_sections import written
from synthetic_output import document, events, walk_arrays, write_output


def shown(directory):
    return Page(render(directory, "quality")).text


def test_contacts_are_counted_and_refusals_told(tmp_path):
    text = shown(write_output(tmp_path, written(), walk_arrays()))
    assert "Force plates: 1 of 2 contacts used; not used: the left foot stood on it too (1)." in text


def test_no_contact_is_told(tmp_path):
    assert "Force plates: no contact, so there are no kinetics." in shown(write_output(tmp_path, document()))


def test_each_trial_has_events_on_its_own_clock(tmp_path):
    both = document() | {"events": [*events("walk_1"), *events("walk_2")]}
    text = shown(write_output(tmp_path, both))
    first, second = text.split("walk_1: times from the first stored frame")[1].split("walk_2: times from the first")
    assert first.count("0.050 left foot strike") == 1 and second.count("0.050 left foot strike") == 1


def test_strides_in_different_directions_are_warned_of(tmp_path):
    turned = document()
    turned["kinematics"]["pelvis_rotation"]["left"]["sd"] = [40.0] * 101
    said = Page(render(write_output(tmp_path / "turned", turned), "front")).text
    assert "standard deviation of pelvis rotation 40 deg" in said
    straight = Page(render(write_output(tmp_path / "straight", document()), "front")).text
    assert "different directions" not in straight
