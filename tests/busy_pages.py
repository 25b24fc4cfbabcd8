"""Much to look at: a result of many strides, and the results of many patients."""

import copy
import json
from datetime import date
from uuid import UUID, uuid4

import numpy as np
from synthetic_output import CURVES, angle, document, walk_arrays, write_output

from gaitlab.jobs.imported import import_result
from gaitlab.jobs.request import JobRequest
from gaitlab.storage.models import GaitSession, JobKind, Patient, Role

STRIDE = 1.1  # [s]
KINETICS = {
    "hip_extensor_moment": "N*m/kg",
    "knee_extensor_moment": "N*m/kg",
    "ankle_plantarflexor_moment": "N*m/kg",
    "hip_power": "W/kg",
    "knee_power": "W/kg",
    "ankle_power": "W/kg",
    "ground_reaction_vertical": "%",
    "ground_reaction_forward": "%",
    "ground_reaction_medial": "%",
}


def many_strides(folder, n_strides):
    """An output directory with this many strides of each side, in 18 curves; angles and kinetics over time."""
    written = document("walk")
    time = np.arange(round((n_strides + 2) * STRIDE * 100)) / 100.0
    strides = [
        {"trial": "walk", "side": side, "start_s": start + k * STRIDE, "end_s": start + (k + 1) * STRIDE}
        for side, start in (("left", 0.05), ("right", 0.6))
        for k in range(n_strides)
    ]
    written["strides"] = {"strides": strides, "rule": "", "consistency": {}}
    curve = written["kinematics"]["hip_flexion"]
    curves = {name: {"unit": unit, **curve} for name, unit in KINETICS.items()}
    written["kinetics"] = {"curves": curves, "moments_in": "segment", "contacts": [], "missing": []}
    write_output(folder, written, walk_arrays())
    for name, names in (("angles.csv", CURVES), ("kinetics.csv", KINETICS)):
        values = {f"{side}_{each}": angle("hip_flexion", time, side) for side in ("left", "right") for each in names}
        table = np.column_stack([time, *values.values()])
        header = ",".join(["time", *values])
        np.savetxt(folder / name, table, delimiter=",", header=header, comments="", fmt="%.4f")
    return folder


def add_result(world, folder, patient_id, session_id):
    """Id of a result in the database of a clinic."""
    request = JobRequest(
        kind=JobKind.ANALYSE,
        inputs=(),
        patients=frozenset({UUID(str(patient_id))}),
        session_id=UUID(str(session_id)),
        settings={"number": uuid4().hex},
    )
    with world.services.database.transaction() as session:
        return str(import_result(session, world.services.files, request, folder).id)


def add_patients(world, folder, n):
    """Ids of the results of this many new patients, one each, with numbers of their own."""
    owner, results = world.people[Role.CLINICIAN].id, []
    plain = document("walk")
    for number in range(n):
        with world.services.database.transaction() as db:
            patient = Patient(pseudonym=f"M-{number:04}", created_by=owner)
            db.add(patient)
            db.flush()
            visit = GaitSession(patient_id=patient.id, visited_on=date(2026, 11, 20))
            db.add(visit)
            db.flush()
            ids = patient.id, visit.id
        written = copy.deepcopy(plain)
        for side in ("left", "right"):
            written["spatiotemporal"][side]["mean"]["speed_m_per_s"] = 0.5 + (number * 7919 % n) / n
        (folder / "result.json").write_text(json.dumps(written))
        results.append(add_result(world, folder, *ids))
    return results
