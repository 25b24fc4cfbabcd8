"""An output directory made of simple functions: a stick figure that walks, for tests of report and viewer."""

import csv
import json

import numpy as np

CURVES = {
    "pelvis_tilt": (10.0, 3.0),
    "pelvis_obliquity": (0.0, 5.0),
    "pelvis_rotation": (0.0, 7.0),
    "hip_flexion": (18.0, 22.0),
    "hip_adduction": (0.0, 6.0),
    "hip_rotation": (2.0, 5.0),
    "knee_flexion": (28.0, 27.0),
    "ankle_dorsiflexion": (2.0, 12.0),
    "foot_progression": (-6.0, 4.0),
}
CRITERIA = ("stability", "torque", "hip_adduction_torque", "hip_rotation_torque")
SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot", "left_thigh", "left_shank", "left_foot")
TIPS = ("right_toe", "left_toe")
CONTACTS = ("right_heel", "right_toe", "left_heel", "left_toe")
BONES = ((0, 1), (1, 2), (2, 3), (3, 7), (0, 4), (4, 5), (5, 6), (6, 8))
MASS, RATE, N_FRAMES, STRIDE = 42.0, 100.0, 241, 1.1
SPEED = 1.1  # [m/s], along the laboratory's -y axis


def phase_of(time, side):
    return 2.0 * np.pi * (time / STRIDE + (0.5 if side == "left" else 0.0))


def angle(name, time, side):
    mean, amplitude = CURVES[name]
    return mean + amplitude * np.cos(phase_of(time, side)) + 0.4 * amplitude * np.cos(2.0 * phase_of(time, side) + 1.0)


def walk_arrays():
    """Arrays of walk.npz; the model-optimal figure lags a little behind the measured one."""
    time = np.arange(N_FRAMES) / RATE
    measured, optimal = figure(time, 1.0), figure(time, 0.9)
    load = {side: np.clip(np.sin(phase_of(time, side)), 0.0, None) * 1.1 * MASS * 9.81 for side in ("right", "left")}
    forces = np.zeros((N_FRAMES, 4, 3))
    for index, name in enumerate(CONTACTS):
        vertical = load[name.split("_")[0]] / 2.0
        forces[:, index] = np.stack([0.03 * vertical, 0.15 * vertical, vertical], axis=1)
    plates = np.stack([forces[:, :2].sum(axis=1), forces[:, 2:].sum(axis=1)], axis=1) * 1.05
    cop = np.stack([measured[:, 7], measured[:, 8]], axis=1) * (1.0, 1.0, 0.0)
    q = np.zeros((N_FRAMES, 24))
    for k in range(7):
        q[:, 3 + 3 * k] = np.radians(angle("hip_flexion", time + 0.1 * k, "left" if k > 3 else "right"))
    stages = np.array(["right single support", "double support", "left single support"])
    share = np.abs(np.sin(np.outer(time, (2.0, 3.0, 5.0, 7.0)))) + 0.1
    return {
        "time": time,
        "q_measured": q,
        "q_optimal": 0.95 * q,
        "forces_optimal": forces,
        "contact_names": np.array(CONTACTS),
        "segment_names": np.array(SEGMENTS + TIPS),
        "segment_positions_measured": measured,
        "segment_positions_optimal": optimal,
        "centre_of_mass_measured": measured[:, 0] + (0.0, 0.0, 0.1),
        "markers": np.concatenate([measured + (0.03, 0.0, 0.02), measured - (0.03, 0.0, 0.0)], axis=1),
        "marker_names": np.array([f"M{k}" for k in range(18)]),
        "bones": np.array(BONES),
        "phase": stages[(np.arange(N_FRAMES) // 40) % 3],
        "grf_plates": plates,
        "cop_plates": cop,
        "criteria_share": share,
    }


def figure(time, amplitude):
    """Positions of pelvis, joints and toes [m], shape (n, 9, 3): a planar walk along -y."""
    pelvis = np.stack(
        [0.4 + 0.02 * np.sin(phase_of(time, "left")), 1.5 - SPEED * time, np.full_like(time, 0.86)], axis=1
    )
    points = {"pelvis": pelvis}
    for side, sign in (("right", -1.0), ("left", 1.0)):
        hip = pelvis + (sign * 0.08, 0.0, -0.05)
        flexion = amplitude * np.radians(25.0 * np.cos(phase_of(time, side)))
        bend = amplitude * np.radians(30.0 - 28.0 * np.cos(phase_of(time, side) + 0.8))
        knee = hip + 0.40 * downwards(flexion)
        ankle = knee + 0.38 * downwards(flexion - bend)
        points |= {f"{side}_hip": hip, f"{side}_knee": knee, f"{side}_ankle": ankle}
        points[f"{side}_toe"] = ankle + (0.0, -0.14, -0.05)
    names = (
        "pelvis",
        *(f"{s}_{j}" for s in ("right", "left") for j in ("hip", "knee", "ankle")),
        "right_toe",
        "left_toe",
    )
    return np.stack([points[name] for name in names], axis=1)


def downwards(flexion):
    return np.stack([np.zeros_like(flexion), -np.sin(flexion), -np.cos(flexion)], axis=1)


def curve(name, side):
    mean = angle(name, np.linspace(0.0, STRIDE, 101), side)
    return {"mean": mean.tolist(), "sd": np.full(101, 1.5).tolist(), "n_cycles": 2}


def spatiotemporal(side):
    mean = {
        "speed_m_per_s": 1.1 if side == "left" else 1.09,
        "cadence_steps_per_min": 109.1,
        "stride_length_m": 1.21,
        "step_length_m": 0.6,
        "step_width_m": 0.11,
        "stride_time_s": 1.1,
        "step_time_s": 0.55,
        "foot_off_percent": 61.0 if side == "left" else 63.5,
        "opposite_foot_off_percent": 11.0,
        "opposite_foot_strike_percent": 50.0,
        "single_support_percent": 39.0,
        "double_support_percent": 22.0,
        "stance_percent": 61.0,
        "swing_percent": None,
    }
    sd = {name: None if value is None else 0.02 * value for name, value in mean.items()}
    normalised = {"speed": 0.4, "cadence": 0.5, "stride_length": 1.6, "step_length": 0.8, "step_width": None}
    return {"n_cycles": 2, "mean": mean, "sd": sd, "normalised": normalised, "cycles": [mean, mean]}


def weights(status="solved"):
    values, sds = (0.55, 0.3, 0.1, 0.05), (0.04, 0.06, 0.03, None)
    criteria = [
        {
            "name": name,
            "weight": value,
            "sd": sd,
            "identifiable": sd is not None,
            "raw_weight": value * 1234.5,
            "cost_share": value,
        }
        for name, value, sd in zip(CRITERIA, values, sds, strict=True)
    ]
    strides = [
        {
            "trial": trial,
            "side": "left",
            "start_s": 0.4,
            "end_s": 1.5,
            "weights": dict(zip(CRITERIA, values, strict=True)),
        }
        for trial in ("walk_1", "walk_2")
    ]
    return {
        "criteria": criteria,
        "fit": {"rms_rad": 0.038, "per_joint": {"left_hip": 0.03, "right_knee": 0.05}},
        "solver": {
            "status": status,
            "kkt_residual": 3.2e-8,
            "iterations": 14,
            "seconds": 21.7,
            "reduced_hessian": "positive definite",
        },
        "correlation": (0.9 * np.eye(4) + 0.1).tolist(),
        "comparison": {
            "equal_weights_rms_rad": 0.051,
            "single_criterion_rms_rad": dict(zip(CRITERIA, (0.06, 0.047, 0.08, None), strict=True)),
        },
        "strides": strides,
        "pooled": {
            "n_strides": 2,
            "weights": dict(zip(CRITERIA, values, strict=True)),
            "between_stride_sd": dict.fromkeys(CRITERIA, 0.03),
        },
    }


def events(trial):
    moments = [("left", "foot_strike", 0.05), ("left", "foot_off", 0.72), ("left", "foot_strike", 1.15)]
    moments += [("right", "foot_strike", 0.6), ("right", "foot_off", 1.28), ("right", "foot_strike", 1.7)]
    moments += [("left", "foot_off", 1.82), ("left", "foot_strike", 2.25)]
    return [{"side": s, "kind": k, "time_s": t, "source": "detected", "trial": trial} for s, k, t in moments]


def document(trial="walk_1", status="solved"):
    """A complete result.json as the contract in gaitlab.clinical.document has it."""
    inputs = [
        {"name": f"{name}.c3d", "role": role, "sha256": digit * 64, "rate_hz": 100.0, "n_frames": N_FRAMES}
        for name, role, digit in (("static", "static", "a"), (trial, "walk", "b"))
    ]
    return {
        "version": "0.1.0",
        "inputs": inputs,
        "subject": {"mass_kg": MASS, "height_m": 1.46, "parameters": {"left_leg_length": 0.78}, "assumed": ["height"]},
        "events": events(trial),
        "spatiotemporal": {side: spatiotemporal(side) for side in ("left", "right")},
        "kinematics": {name: {side: curve(name, side) for side in ("left", "right")} for name in CURVES},
        "weights": weights(status),
        "quality": {
            "gaps": [{"trial": trial, "marker": "LKNE", "start_s": 0.2, "end_s": 0.25, "filled": True}],
            "calibration": {
                "used": "computed",
                "computed": {"left_plantar_flexion": 0.051},
                "stored": {"left_plantar_flexion": 0.048},
            },
            "marker_residual_rms_m": 0.0094,
            "marker_residuals_m": {"LKNE": 0.012, "LASI": 0.004},
        },
        "settings": {"seed": 0, "cut_off": 6.0, "criteria": list(CRITERIA)},
        "warnings": ["LKNE is missing from 0.20 s to 0.25 s and was filled"],
    }


def write_output(directory, written, arrays=None, angles=True):
    """Write result.json, and walk.npz and angles.csv if wanted."""
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "result.json").write_text(json.dumps(written))
    if arrays is not None:
        np.savez_compressed(directory / "walk.npz", **arrays)
    if angles:
        time = np.arange(N_FRAMES) / RATE
        columns = {f"{side}_{name}": angle(name, time - 0.05, side) for side in ("left", "right") for name in CURVES}
        with (directory / "angles.csv").open("w", newline="") as stream:
            writer = csv.writer(stream)
            writer.writerow(("time", *columns))
            writer.writerows(zip(time, *columns.values(), strict=True))
    return directory
