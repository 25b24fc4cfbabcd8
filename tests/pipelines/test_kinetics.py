import numpy as np

from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.inverse.leg_kinetics import MOMENTS, POWERS, REACTIONS, Kinetics, KineticsSettings
from gaitlab.mocap.plate_assignment import PlateContact
from gaitlab.pipelines.kinetics import TrialKinetics, emg_entry, kinetics_columns, kinetics_entry

N = 50


def trial(name="walk", sides=("left",), missing=(), reason=""):
    """A walk with one cycle of ones on some sides."""
    contacts = tuple(PlateContact(plate=1, start=0.1, end=0.7, side=side, reason=reason) for side in sides)
    flat = {f"{side}_{curve}": np.ones(N) for side in ("left", "right") for curve in UNITS}
    nowhere = {side: np.full((N, 3), np.nan) for side in ("left", "right")}
    twist = {side: np.full(N, np.nan) for side in ("left", "right")}
    solved = Kinetics(
        contacts=contacts, curves=flat, pressure=nowhere, free_moment=twist, settings=KineticsSettings(frame="joint")
    )
    whole, broken = np.ones(101), np.full(101, np.nan)
    curves = {curve: {side: (whole if side in sides else broken,) for side in ("left", "right")} for curve in UNITS}
    return TrialKinetics(name=name, kinetics=solved, curves=curves, emg={}, missing=tuple(missing), warnings=())


def without_plates(name="walk"):
    missing = (f"{name}: no kinetics, the file holds no usable force plate",)
    return TrialKinetics(name=name, kinetics=None, curves={}, emg={}, missing=missing, warnings=())


def test_names_are_those_of_the_dynamics():
    assert set(UNITS) == {*MOMENTS, *POWERS, *REACTIONS}


def test_only_cycles_with_a_known_ground_are_averaged():
    entry = kinetics_entry([trial(), trial("again")])
    curve = entry.curves["hip_power"]
    assert (curve.unit, curve.left.n_cycles, curve.right) == ("W/kg", 2, None)
    assert curve.left.mean == [1.0] * 101 and curve.left.sd == [0.0] * 101
    assert entry.moments_in == "the joint coordinate system (projections)"


def test_a_file_without_plates_says_so():
    entry = kinetics_entry([without_plates()])
    assert entry.curves == {} and entry.contacts == []
    assert entry.missing == ["walk: no kinetics, the file holds no usable force plate"]


def test_trials_with_and_without_plates_go_together():
    entry = kinetics_entry([without_plates("first"), trial("second")])
    assert entry.curves["knee_power"].left.n_cycles == 1 and len(entry.missing) == 1


def test_a_contact_without_a_complete_stride_is_told():
    one = trial()
    cut = TrialKinetics(**{**vars(one), "curves": {}})
    (sentence,) = kinetics_entry([cut]).missing
    assert sentence.startswith("no average of the left side")


def test_contacts_are_listed_with_their_reasons():
    (contact,) = kinetics_entry([trial(reason="the right foot stood on it too")]).contacts
    assert (contact.plate, contact.side, contact.accepted) == (2, "left", False)
    assert contact.reason == "the right foot stood on it too"


def test_no_emg_no_entry():
    assert emg_entry([trial()]) is None


def test_columns_of_the_table():
    columns = kinetics_columns(trial().kinetics)
    assert len(columns) == 2 * (len(UNITS) + 4)
    assert all(column.shape == (N,) for column in columns.values())
    assert {"left_hip_extensor_moment", "right_pressure_z", "right_free_moment"} <= set(columns)
