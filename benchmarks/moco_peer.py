"""OpenSim Moco tracks a stride: `python moco_peer.py PROBLEM.json`, result as JSON on the last line of its output.

Same bodies, joints and reference as ours; every joint coordinate has a torque actuator. The floor is six actuators at
the pelvis, so Moco has neither contacts nor unilateral forces to find: its problem is easier than ours.
"""

import json
import sys
import time

import numpy as np
import opensim

AXES = ("y", "x", "z")
UNIT_OF_CONTROL = 100.0
"""Torque [N*m] or force [N] of a control of one: controls are then of the size of angles."""
UNIT = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def model_of(problem: dict) -> opensim.Model:
    """The subject with one actuator per coordinate."""
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -9.81))
    bodies = []
    for segment in problem["segments"]:
        i = np.array(segment["inertia"])
        inertia = opensim.Inertia(i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        body = opensim.Body(segment["name"], segment["mass"], opensim.Vec3(*segment["centre_of_mass"]), inertia)
        parent = model.getGround() if segment["parent"] < 0 else bodies[segment["parent"]]
        transform = opensim.SpatialTransform()
        for k, axis in enumerate(AXES):
            _drive(getattr(transform, f"get_rotation{k + 1}")(), segment, axis)
        if segment["parent"] < 0:
            for k, axis in enumerate("xyz"):
                _drive(getattr(transform, f"get_translation{k + 1}")(), segment, f"t{axis}")
        zero = opensim.Vec3(0.0)
        offset = opensim.Vec3(*segment["joint_offset"])
        joint = opensim.CustomJoint(f"{segment['name']}_joint", parent, offset, zero, body, zero, zero, transform)
        model.addBody(body)
        model.addJoint(joint)
        bodies.append(body)
    model.finalizeConnections()
    coordinates = model.getCoordinateSet()
    for k in range(coordinates.getSize()):
        actuator = opensim.CoordinateActuator(coordinates.get(k).getName())
        actuator.setName(f"drive_{coordinates.get(k).getName()}")
        actuator.setOptimalForce(UNIT_OF_CONTROL)
        actuator.setMinControl(-2000.0 / UNIT_OF_CONTROL)
        actuator.setMaxControl(2000.0 / UNIT_OF_CONTROL)
        model.addForce(actuator)
    return model


def _drive(axis: opensim.TransformAxis, segment: dict, name: str) -> None:
    names = opensim.ArrayStr()
    names.append(f"{segment['name']}_{name}")
    axis.setCoordinateNames(names)
    axis.setAxis(opensim.Vec3(*UNIT[name[-1]]))
    axis.set_function(opensim.LinearFunction(1.0, 0.0))


def study_of(problem: dict, model: opensim.Model) -> opensim.MocoStudy:
    """Tracking of the reference with the weights of ours, one mesh interval per interval of ours."""
    study = opensim.MocoStudy()
    task = study.updProblem()
    task.setModel(model)
    times, reference = np.array(problem["times"]), np.array(problem["reference"])
    task.setTimeBounds(times[0], times[-1])
    table = opensim.TimeSeriesTable()
    labels = [f"/jointset/{name.rsplit('_', 1)[0]}_joint/{name}/value" for name in problem["names"]]
    table.setColumnLabels(labels)
    table.addTableMetaDataString("inDegrees", "no")
    for t, row in zip(times, reference, strict=True):
        table.appendRow(t, opensim.RowVector(row.tolist()))
    for label, column in zip(labels, reference.T, strict=True):
        margin = 1.0
        task.setStateInfo(label, [float(column.min()) - margin, float(column.max()) + margin])
        task.setStateInfo(label.replace("/value", "/speed"), [-50.0, 50.0])
    track = opensim.MocoStateTrackingGoal("track", 1.0)
    track.setReference(opensim.TableProcessor(table))
    for name, label in zip(problem["names"], labels, strict=True):
        track.setWeightForState(label, problem["translation_weight"] if name.startswith("pelvis_t") else 1.0)
    task.addGoal(track)
    effort = opensim.MocoControlGoal("effort", 1.0)
    for name in problem["names"]:
        weight = problem["force_weight"] if name.startswith("pelvis_") else problem["torque_weight"]
        effort.setWeightForControl(f"/forceset/drive_{name}", weight * UNIT_OF_CONTROL**2)
    task.addGoal(effort)
    solver = study.initCasADiSolver()
    solver.set_num_mesh_intervals(len(times) - 1)
    # Moco's own defaults; with implicit dynamics it did not converge in 20 minutes.
    solver.set_multibody_dynamics_mode("explicit")
    solver.set_optim_convergence_tolerance(1e-3)
    solver.set_optim_constraint_tolerance(1e-3)
    solver.set_parallel(0)
    solver.set_verbosity(0)
    guess = solver.createGuess("bounds")
    guess.insertStatesTrajectory(_states(problem, labels), True)
    solver.setGuess(guess)
    return study


def _states(problem: dict, labels: list[str]) -> opensim.TimeSeriesTable:
    """Values and speeds that the search starts from."""
    table = opensim.TimeSeriesTable()
    table.setColumnLabels([*labels, *(label.replace("/value", "/speed") for label in labels)])
    for t, q, v in zip(problem["times"], problem["reference"], problem["velocities"], strict=True):
        table.appendRow(t, opensim.RowVector([*q, *v]))
    return table


def main(path: str) -> None:
    """Solve and print."""
    with open(path) as file:
        problem = json.load(file)
    begin = time.process_time()
    study = study_of(problem, model_of(problem))
    solution = study.solve()
    seconds = time.process_time() - begin
    success = bool(solution.success())
    if not success:
        solution.unseal()
    times, found = solution.getTimeMat(), solution.getStatesTrajectoryMat()
    names = list(solution.getStateNames())
    angles = [n for n in problem["names"] if not n.startswith("pelvis_t")]
    gaps = []
    for name in angles:
        column = next(i for i, label in enumerate(names) if label.endswith(f"/{name}/value"))
        own = np.interp(problem["times"], times, found[:, column])
        gaps.append(own - np.array(problem["reference"])[:, problem["names"].index(name)])
    result = {"success": success, "seconds": seconds, "iterations": solution.getNumIterations()}
    print(json.dumps(result | {"rms_rad": float(np.sqrt(np.mean(np.square(gaps))))}))


if __name__ == "__main__":
    main(sys.argv[1])
