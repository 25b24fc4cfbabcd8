"""Issue 5, line 1: moments and powers against the file's own over accepted contacts, contacts, heights of plates."""

from collections.abc import Iterator
from functools import cache

import numpy as np
from registry import CHILDREN, Row, measurement
from vicon import recording, rms

from gaitlab.inverse.conventional import joint_kinematics
from gaitlab.inverse.leg_kinetics import Kinetics, KineticsSettings, solve_kinetics
from gaitlab.inverse.static import calibrate_subject
from gaitlab.mocap.events import events_of
from gaitlab.mocap.plate_assignment import PlateContact, assign_contacts
from gaitlab.mocap.recording import Recording
from gaitlab.multibody.scaling import SubjectSettings
from gaitlab.pipelines.model import person_model
from gaitlab.signal.runs import runs

STRAIGHT = (
    *((f"children/{child}/static_*.c3d", f"children/{child}/straight_*.c3d") for child in CHILDREN),
    ("fmc_adult/*BP01.c3d", "fmc_adult/*BP06.c3d"),
    ("fmc_adult/*BP08.c3d", "fmc_adult/*BP15.c3d"),
)
TURNS = tuple((f"children/{child}/static_*.c3d", f"children/{child}/turn_*.c3d") for child in CHILDREN)
STAIRS = ("stairs_adult/Static_trial.c3d", "stairs_adult/Movement_trial.c3d")
SAGITTAL = {"hip": "extensor", "knee": "extensor", "ankle": "plantarflexor"}
EDGE = 4  # frames at the ends of a trial in which Vicon writes nothing
LOADED = 5.0  # [N/kg]; the file has the contact, too


@cache
def _kinetics(static_pattern: str, pattern: str, inertia: str) -> tuple[Recording, Kinetics]:
    static, walk = recording(static_pattern), recording(pattern)
    calibration = calibrate_subject(static, walk, {})
    standing = joint_kinematics(static, calibration)
    subject = person_model(static, standing, calibration.parameters, SubjectSettings())
    events = events_of(walk)
    steps = (assign_contacts(walk, events), events)
    kinematics = joint_kinematics(walk, calibration)
    return walk, solve_kinetics(walk, kinematics, subject, steps, KineticsSettings(inertia=inertia))


@measurement(issue=5, line=1)
def kinetics_of_straight_walks() -> Iterator[Row]:
    for pair in STRAIGHT:
        yield from _differences(*_kinetics(*pair, "subject"), limits=("<= 0.06", "<= 0.15"))


@measurement(issue=5, line=1)
def kinetics_of_turns_and_stairs() -> Iterator[Row]:
    for pair in (*TURNS, STAIRS):
        yield from _differences(*_kinetics(*pair, "subject"), limits=("", ""))


@measurement(issue=5, line=1)
def kinetics_with_the_inertia_of_plug_in_gait() -> Iterator[Row]:
    for pair in (*STRAIGHT, *TURNS, STAIRS):
        yield from _differences(*_kinetics(*pair, "plug-in gait"), limits=("", ""))


@measurement(issue=5, line=1)
def contacts_of_the_files() -> Iterator[Row]:
    for pair, limit in [*((pair, "<= 0") for pair in STRAIGHT), *((pair, "") for pair in (*TURNS, STAIRS))]:
        walk, kinetics = _kinetics(*pair, "subject")
        ours = [c for c in kinetics.contacts if c.accepted]
        in_file = [c for c in ours if _in_file(walk, c)]
        n_file = sum(len(_file_contacts(walk, letter)) for letter in "LR")
        for words, count in (("only here", len(ours) - len(in_file)), ("only in the file", n_file - len(in_file))):
            yield Row(quantity=f"contacts {words}", value=float(count), limit=limit, unit="", subject=walk.name)


@measurement(issue=5, line=1)
def heights_of_raised_plates() -> Iterator[Row]:
    walk, kinetics = _kinetics(*STAIRS, "subject")
    for contact in kinetics.contacts:
        middle = round((contact.start + contact.end) / 2 * walk.rate)
        height = walk.force_plates[contact.plate].corners[:, 2].mean()
        error = 1e3 * abs(kinetics.pressure[contact.side][middle, 2] - height)
        words = f"height of the pressure on plate {contact.plate + 1} ({height:.3f} m)"
        yield Row(quantity=words, value=float(error), limit="<= 1", unit="mm", subject=walk.name)


def _differences(walk: Recording, kinetics: Kinetics, limits: tuple[str, str]) -> Iterator[Row]:
    for contact in kinetics.contacts:
        if not contact.accepted or not _in_file(walk, contact):
            continue
        side, letter = contact.side, contact.side[0].upper()
        frames = _frames(walk, contact)
        for joint, word in SAGITTAL.items():
            name = joint.capitalize()
            moment = walk.model_outputs[f"{letter}{name}Moment"][frames, 0] / 1000
            power = walk.model_outputs[f"{letter}{name}Power"][frames, 2]
            moment = kinetics.curves[f"{side}_{joint}_{word}_moment"][frames] - moment
            power = kinetics.curves[f"{side}_{joint}_power"][frames] - power
            kinds = zip((moment, power), ("moment", "power"), limits, ("N*m/kg", "W/kg"), strict=True)
            for difference, kind, limit, unit in kinds:
                words = f"{side} {joint} {kind}, plate {contact.plate + 1}"
                yield Row(quantity=words, value=rms(difference), limit=limit, unit=unit, subject=walk.name)


def _frames(walk: Recording, contact: PlateContact) -> slice:
    first = int(np.ceil(contact.start * walk.rate))
    return slice(max(first, EDGE), min(int(contact.end * walk.rate) + 1, walk.n_frames - EDGE))


def _file_contacts(walk: Recording, letter: str) -> list[tuple[int, int]]:
    """Frames in which the file gives this foot a ground reaction, as (start, end)."""
    force = walk.model_outputs.get(f"{letter}GroundReactionForce")
    return [] if force is None else runs(np.nan_to_num(force[:, 2]) > 0.0)


def _in_file(walk: Recording, contact: PlateContact) -> bool:
    start, end = contact.start * walk.rate, contact.end * walk.rate
    theirs = _file_contacts(walk, contact.side[0].upper())
    return any(min(end, last) - max(start, first) > 0.9 * (end - start) for first, last in theirs)
