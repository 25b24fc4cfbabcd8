import numpy as np
import pytest
from synthetic_walk import synthetic_walk

from gaitlab.inverse.conventional import joint_kinematics
from gaitlab.inverse.leg_kinetics import MOMENTS, POWERS, KineticsSettings, ground_is_known, solve_kinetics
from gaitlab.inverse.static import calibrate_subject
from gaitlab.mocap.events import events_of
from gaitlab.mocap.plate_assignment import PlateContact, assign_contacts
from gaitlab.mocap.recording import Event
from gaitlab.multibody.scaling import SubjectSettings
from gaitlab.pipelines.model import person_model

WALK = synthetic_walk()
VICON_AXIS = {"extensor": 0, "plantarflexor": 0, "abductor": 1, "evertor": 1, "external": 2}
EDGE = 4  # frames at the ends of a trial in which Vicon writes nothing
PAIRS = {
    **{f"children/{c}/straight_*": f"children/{c}/static_*" for c in ("HC002D", "HC030A", "HC032A", "HC033A")},
    **{f"children/{c}/straight_*": f"children/{c}/static_*" for c in ("HC040A", "HC050A")},
    "fmc_adult/*BP06": "fmc_adult/*BP01",
    "fmc_adult/*BP15": "fmc_adult/*BP08",
    "stairs_adult/Movement_trial": "stairs_adult/Static_trial",
}


@pytest.fixture(scope="module")
def solved(trial):
    """Kinetics of a walk by the name of its file, for chosen settings."""
    prepared = {}

    def solve(pattern, **settings):
        if pattern not in prepared:
            walk, static = trial(pattern), trial(PAIRS[pattern])
            calibration = calibrate_subject(static, walk, {})
            standing = joint_kinematics(static, calibration)
            subject = person_model(static, standing, calibration.parameters, SubjectSettings())
            events = events_of(walk)
            steps = (assign_contacts(walk, events), events)
            prepared[pattern] = (walk, joint_kinematics(walk, calibration), subject, steps)
        return prepared[pattern][0], solve_kinetics(*prepared[pattern], KineticsSettings(**settings))

    return solve


def differences(walk, kinetics, names):
    """Rms difference to the file's own curves over each accepted contact that the file has, too."""
    found = {}
    for contact in kinetics.contacts:
        letter, first = contact.side[0].upper(), int(np.ceil(contact.start * walk.rate))
        frames = slice(max(first, EDGE), min(int(contact.end * walk.rate) + 1, walk.n_frames - EDGE))
        load = walk.model_outputs[f"{letter}GroundReactionForce"][frames, 2]
        if not np.nan_to_num(load).max() > 5.0:  # N/kg
            continue
        for name in names:
            joint, word = name.split("_")[:2]
            if word == "power":
                theirs = walk.model_outputs[f"{letter}{joint.capitalize()}Power"][frames, 2]
            else:
                theirs = walk.model_outputs[f"{letter}{joint.capitalize()}Moment"][frames, VICON_AXIS[word]] / 1000
            ours = kinetics.curves[f"{contact.side}_{name}"][frames]
            found[contact.plate, name] = float(np.sqrt(np.mean((ours - theirs) ** 2)))
    return found


SAGITTAL = ("hip_extensor_moment", "knee_extensor_moment", "ankle_plantarflexor_moment")


@pytest.mark.shared_data
@pytest.mark.parametrize("pattern", PAIRS)
def test_moments_and_powers_are_those_of_the_file(solved, pattern):
    walk, kinetics = solved(pattern)
    moments, powers = differences(walk, kinetics, SAGITTAL), differences(walk, kinetics, POWERS)
    assert len(moments) == 6 and len(powers) == 6
    assert max(moments.values()) < 0.06
    assert max(powers.values()) < 0.15


@pytest.mark.shared_data
@pytest.mark.parametrize("pattern", ["children/HC033A/straight_*", "fmc_adult/*BP06"])
def test_the_difference_is_vicon_s_inertia(solved, pattern):
    walk, kinetics = solved(pattern, inertia="plug-in gait")
    assert max(differences(walk, kinetics, MOMENTS).values()) < 0.02


@pytest.mark.shared_data
def test_the_frame_changes_the_parts_and_not_the_whole(solved):
    pattern = "children/HC033A/straight_*"
    sizes, powers = [], []
    for frame in ("distal", "proximal", "laboratory"):
        _, kinetics = solved(pattern, frame=frame)
        sizes.append(sum(kinetics.curves[f"left_{name}"] ** 2 for name in MOMENTS if name.startswith("knee")))
        powers.append(kinetics.curves["left_knee_power"])
    assert sizes[1] == pytest.approx(sizes[0], nan_ok=True) and sizes[2] == pytest.approx(sizes[0], nan_ok=True)
    assert powers[1] == pytest.approx(powers[0], nan_ok=True)


@pytest.mark.shared_data
def test_the_joint_s_axes_are_the_flexion_axis_above_and_the_long_axis_below(solved):
    pattern = "children/HC033A/straight_*"
    joint, proximal, distal = (solved(pattern, frame=f)[1].curves for f in ("joint", "proximal", "distal"))
    name = "left_knee_extensor_moment"
    assert joint[name] == pytest.approx(proximal[name], nan_ok=True)
    name = "left_knee_external_rotator_moment"
    assert joint[name] == pytest.approx(distal[name], nan_ok=True)


@pytest.mark.shared_data
def test_the_ground_carries_the_body(solved):
    walk, kinetics = solved("fmc_adult/*BP06")
    ours = kinetics.curves["left_ground_reaction_vertical"]
    theirs = walk.model_outputs["LGroundReactionForce"][:, 2] / 9.81 * 100.0
    contact = next(c for c in kinetics.contacts if c.side == "left")
    frames = slice(round(contact.start * walk.rate) + 1, round(contact.end * walk.rate))
    assert ours[frames] == pytest.approx(theirs[frames], abs=1.5)


@pytest.mark.shared_data
def test_the_pressure_lies_on_the_step(solved):
    walk, kinetics = solved("stairs_adult/Movement_trial")
    for contact in kinetics.contacts:
        height = walk.force_plates[contact.plate].corners[:, 2].mean()
        middle = round((contact.start + contact.end) / 2 * walk.rate)
        assert kinetics.pressure[contact.side][middle, 2] == pytest.approx(height, abs=1e-3)


@pytest.mark.shared_data
def test_smoothing_is_a_choice(solved):
    pattern = "children/HC033A/straight_*"
    rough, smooth = (solved(pattern, cut_off=f)[1].curves["left_hip_power"] for f in (0.0, 6.0))
    known = np.isfinite(rough)
    assert np.isfinite(smooth[known]).all() and np.abs(smooth - rough)[known].max() > 0.05


def contact(reason=""):
    return PlateContact(plate=0, start=1.0, end=1.6, side="left", reason=reason)


EVENTS = tuple(
    Event(side="left", kind=kind, time=time, source="file")
    for kind, time in (("foot_off", 0.5), ("foot_strike", 0.98), ("foot_off", 1.62), ("foot_strike", 2.1))
)


def known_times(found, events):
    return np.flatnonzero(ground_is_known(WALK, found, events, "left")) / WALK.rate


def test_swing_and_accepted_stance_are_known():
    times = known_times([contact()], EVENTS)
    assert (times[0], times[-1]) == pytest.approx((0.5, 2.1)) and len(times) == 161


def test_a_rejected_stance_is_unknown():
    times = known_times([contact("the right foot stood on it too")], EVENTS)
    assert not ((times > 0.99) & (times < 1.61)).any() and len(times) > 0


def test_without_events_only_the_contact_is_known():
    times = known_times([contact()], ())
    assert (times[0], times[-1]) == pytest.approx((0.99, 1.61))
