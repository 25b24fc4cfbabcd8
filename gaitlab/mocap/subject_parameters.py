"""Body measurements stored in a C3D file, in SI units under names of our own."""

import re
from collections.abc import Mapping

import numpy as np

from gaitlab.mocap.raw import RawRecording

LENGTHS: Mapping[str, tuple[str, float, float]] = {
    "HEIGHT": ("height", 0.4, 2.5),
    "BODYHEIGHT": ("height", 0.4, 2.5),
    "INTERASISDISTANCE": ("inter_asis_distance", 0.06, 0.6),
    "MARKERDIAMETER": ("marker_diameter", 0.002, 0.05),
}
"""Name in capitals to (our name, smallest and largest plausible value [m])."""

SIDED_LENGTHS: Mapping[str, tuple[str, float, float]] = {
    "LEGLENGTH": ("leg_length", 0.2, 1.4),
    "KNEEWIDTH": ("knee_width", 0.03, 0.3),
    "ANKLEWIDTH": ("ankle_width", 0.02, 0.2),
    "ASISTROCANTERDISTANCE": ("asis_trochanter", 0.01, 0.2),
    "ASISTROCHANTERDISTANCE": ("asis_trochanter", 0.01, 0.2),
    "SHOULDEROFFSET": ("shoulder_offset", 0.005, 0.2),
    "ELBOWWIDTH": ("elbow_width", 0.02, 0.2),
    "WRISTWIDTH": ("wrist_width", 0.02, 0.15),
    "HANDTHICKNESS": ("hand_thickness", 0.005, 0.1),
}

SIDED_ANGLES: Mapping[str, str] = {
    "THIGHROTATION": "thigh_rotation",
    "SHANKROTATION": "shank_rotation",
    "TIBIALTORSION": "tibial_torsion",
    "STATICPLANTFLEX": "static_plantar_flexion",
    "STATICROTOFF": "static_rotation",
    "ANKLEABADD": "ankle_abduction",
}

MASSES = ("BODYMASS", "MASS", "BODYWEIGHT")
SCALES = (1e-3, 1e-2, 1.0)  # mm first: what Vicon writes
LARGEST_ANGLE = 2.0  # rad; wands reach -1.75 (CGM2 patella markers), no angle in degrees stays below this everywhere
_SIDES = {"L": "left", "R": "right", "LEFT": "left", "RIGHT": "right"}
_PREFERRED = ("PROCESSING", "SUBJECT", "SUBJECTS", "SUBJECT_PARAMETERS", "ANTHROPOMETRY", "ANALYSIS")
_PASSED_OVER = ("POINT", "ANALOG", "FORCE_PLATFORM", "TRIAL", "EVENT", "EVENT_CONTEXT", "MANUFACTURER")


def subject_parameters(raw: RawRecording) -> tuple[dict[str, float], tuple[str, ...]]:
    """Subject parameters of the file and warnings.

    Lengths in m, mass in kg, angles in rad: mass, height, marker_diameter, inter_asis_distance, and with left_ or
    right_: leg_length, knee_width, ankle_width, asis_trochanter, thigh_rotation, shank_rotation, tibial_torsion,
    static_plantar_flexion, static_rotation, ankle_abduction, sole_delta, foot_flat (0 or 1), shoulder_offset ...
    Parameters that are 0 where that means "not measured", or not plausible in mm, cm or m, are left out.
    """
    found = _collect(raw)
    radian = _radian(found, raw)
    parameters: dict[str, float] = {}
    warnings: list[str] = []
    for name, value in found.items():
        known = _interpret(name, value, radian)
        if known is None:
            continue
        key, converted = known
        if converted is None:
            warnings.append(f"the file's {name} = {value:g} is not plausible and not used")
        else:
            parameters.setdefault(key, converted)
    return parameters, tuple(warnings)


def _collect(raw: RawRecording) -> dict[str, float]:
    """Scalar numeric parameters by name in capitals without separators; PROCESSING wins."""
    others = [group for group in raw.parameters if group not in _PREFERRED + _PASSED_OVER]
    found: dict[str, float] = {}
    for group in (*_PREFERRED, *others):
        for name, value in raw.parameters.get(group, {}).items():
            if isinstance(value, np.ndarray) and value.size == 1:
                found.setdefault(re.sub(r"[\s$_-]", "", name), float(value.flat[0]))
    return found


def _interpret(name: str, value: float, radian: float) -> tuple[str, float | None] | None:
    """(our name, SI value or None when it is not plausible); None for a parameter that means nothing to us."""
    if name in MASSES:
        return "mass", value if 1.0 < value < 500.0 else None
    if name in LENGTHS:
        key, low, high = LENGTHS[name]
        return key, _metres(value, low, high)
    match = re.fullmatch(r"(LEFT|RIGHT|L|R)(.+)", name)
    return _sided(_SIDES[match[1]], match[2], value, radian) if match else None


def _sided(side: str, name: str, value: float, radian: float) -> tuple[str, float | None] | None:
    if name in SIDED_LENGTHS:
        key, low, high = SIDED_LENGTHS[name]
        return f"{side}_{key}", _metres(value, low, high)
    if name in SIDED_ANGLES:
        return f"{side}_{SIDED_ANGLES[name]}", value * radian if np.isfinite(value) else None
    if name == "SOLEDELTA":
        return f"{side}_sole_delta", value * 1e-3
    if name == "FOOTFLAT":
        return f"{side}_foot_flat", float(value != 0)
    return None


def _metres(value: float, low: float, high: float) -> float | None:
    """Value [m] in the first of mm, cm, m that makes it plausible."""
    for scale in SCALES:
        if low <= value * scale <= high:
            return value * scale
    return None


def _radian(found: Mapping[str, float], raw: RawRecording) -> float:
    """Radians per unit of the file's angles: Nexus writes radians, Workstation wrote degrees."""
    software = " ".join(raw.texts("MANUFACTURER", "SOFTWARE")).lower()
    if "nexus" in software:
        return 1.0
    angles = [abs(value) for name, value in found.items() if name[1:] in SIDED_ANGLES]
    degrees = "workstation" in software or any(value > LARGEST_ANGLE for value in angles)
    return float(np.pi / 180.0) if degrees else 1.0


def file_parameters(parameters: Mapping[str, float]) -> dict[str, float]:
    """The parameters under Nexus' names and in its units (mm, kg, rad): what `subject_parameters` reads back.

    Args:
        parameters: Our names to SI values; names that Nexus does not have are left out.
    """
    units = {"mass": ("Bodymass", 1.0), "height": ("Height", 1e3)}
    units |= {"inter_asis_distance": ("InterAsisDistance", 1e3), "marker_diameter": ("MarkerDiameter", 1e3)}
    for side in ("left", "right"):
        letter = side[0].upper()
        units |= {f"{side}_{key}": (letter + name, 1e3) for key, name in _NEXUS_LENGTHS.items()}
        units |= {f"{side}_{key}": (letter + name, 1.0) for key, name in _NEXUS_ANGLES.items()}
    return {units[key][0]: value * units[key][1] for key, value in parameters.items() if key in units}


_NEXUS_LENGTHS = {
    "leg_length": "LegLength",
    "knee_width": "KneeWidth",
    "ankle_width": "AnkleWidth",
    "asis_trochanter": "AsisTrocanterDistance",
    "sole_delta": "SoleDelta",
}
_NEXUS_ANGLES = {
    "thigh_rotation": "ThighRotation",
    "shank_rotation": "ShankRotation",
    "tibial_torsion": "TibialTorsion",
    "static_plantar_flexion": "StaticPlantFlex",
    "static_rotation": "StaticRotOff",
    "ankle_abduction": "AnkleAbAdd",
    "foot_flat": "FootFlat",
}
