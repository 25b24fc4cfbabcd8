"""Names of points: which are markers, which are results of other software, and what every marker is called here.

Canonical names are those of Plug-in Gait (LASI, RKNE, SACR ...), of its knee alignment device (LKAX, LKD1, LKD2), of
CGM2 for medial markers (LKNM knee, LMED ankle) and of the Oxford foot model (LCPG, LP1M, LMMA ...).
"""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitlab.errors import InvalidRecording

SIDED = (
    "FHD BHD SHO UPA ELB FRM WRA WRB FIN ASI PSI ILC THI THAP THAD PAT KNE KNM KAX KD1 KD2 TIB TIAP TIAD TTUB "
    "ANK MED HEE TOE HFB TUB SHN MMA CPG PCA LCA STL NAV P1M D1M P5M D5M HLX SMH FMH VMH CUN TRO"
).split()
PELVIS = ("SACR", "LPSI", "RPSI", "LASI", "RASI")
REARFOOT = ("HEE", "CPG", "STL", "LCA", "PCA")  # without the side letter, the most usual first
FOREFOOT = ("TOE", "HLX", "D1M", "D5M", "SMH", "FMH", "VMH", "P1M", "P5M")
CENTRAL = ("C7", "T2", "T6", "T10", "T12", "CLAV", "STRN", "RBAK", "LBAK", "SACR")
CANONICAL = frozenset(side + name for side in "LR" for name in SIDED) | frozenset(CENTRAL)

_SIDED_ALIASES = {
    "ASI": "ASIS ASIA",
    "PSI": "PSIS",
    "THI": "THIGH",
    "KNE": "KNEE LKNE KNELAT KNEELAT KNEL",
    "KNM": "KNEMED KNEEMED MKNE MKNEE KNEM KNEEM KNI MEDKNE",
    "TIB": "TIBIA SHANK",
    "ANK": "ANKLE ANKLAT ANKLELAT",
    "MED": "ANKMED ANKLEMED MANK MANKLE ANKM ANM MEDANK",
    "HEE": "HEEL HEL",
    "TOE": "TOES MT2",
}
ALIASES: Mapping[str, str] = {
    **{
        side + alias: side + name
        for side in "LR"
        for name, aliases in _SIDED_ALIASES.items()
        for alias in aliases.split()
    },
    "SACRUM": "SACR",
    "SAC": "SACR",
}

OUTPUT_GROUPS = ("ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "MODELED_MARKERS", "REACTIONS")
POSITION_GROUPS = ("MODELED_MARKERS",)
_OUTPUT = re.compile(r"(Angles?|Forces?|Moments?|Powers?|GRF|ROT)$|Angles|LegLength$|Index$")
_AXES = re.compile(r"^(PEL|HED|TRX|[LR](FE|TI|FO|TO|CL|HU|RA|HN))[OALP]$|^[LR](HJC|KJC|AJC)|^CentreOfMass|^proj")
_OXFORD = re.compile(r"^[LR]((FOF|HDF|HLX|TIB|D1M|ANK|HE)\d|PROXFF|ArchHeight|HFplantar)$|^PEL0$")  # virtual points
_SUFFIX = re.compile(r"_[A-Za-z]{1,4}$")


@dataclass(frozen=True, kw_only=True)
class Labelled:
    """Points sorted by what they are."""

    markers: Mapping[str, int]
    """Canonical marker name to column of the file's points."""
    positions: Mapping[str, int]
    """Positions that other software computed (LFEP, LKJC ...), name to column."""
    outputs: Mapping[str, int]
    """Other results (LHipAngles, LKneeMoment ...), name to column."""
    warnings: tuple[str, ...] = ()


def strip_prefix(label: str) -> tuple[str, str]:
    """'Anna:LASI' -> ('Anna', 'LASI')."""
    prefix, _, name = label.strip().rpartition(":")
    return prefix.strip(), name.strip()


def canonical_name(name: str) -> str | None:
    """Canonical name of a marker ('lasis', 'LASI_M', 'L.KNEE' ...), None when the name is not known."""
    for candidate in (name, _SUFFIX.sub("", name), name.split("_")[-1]):
        plain = re.sub(r"[\s._-]", "", candidate).upper()
        if plain in CANONICAL:
            return plain
        if plain in ALIASES:
            return ALIASES[plain]
    return None


def sort_labels(labels: Sequence[str], groups: Mapping[str, Iterable[str]]) -> Labelled:
    """Sorts the file's labels.

    Args:
        labels: One per point.
        groups: POINT groups of the file that list model outputs: ANGLES, FORCES ... to labels.

    Unlabelled trajectories ('*52', '') are dropped. Of several subjects the first is used, with a warning.
    """
    split = _without_common_suffix([strip_prefix(label) for label in labels])
    subject, warnings = _choose_subject(split)
    listed = {strip_prefix(label)[1]: group for group, members in groups.items() for label in members}
    markers: dict[str, int] = {}
    exact: set[str] = set()
    positions: dict[str, int] = {}
    outputs: dict[str, int] = {}
    for column, (prefix, name) in enumerate(split):
        if not name or name.startswith("*") or prefix not in ("", subject):
            continue
        if listed.get(name) in POSITION_GROUPS or _AXES.match(name) or _OXFORD.match(name):
            positions.setdefault(name, column)
        elif name in listed or _OUTPUT.search(name):
            outputs.setdefault(name, column)
        else:
            marker = canonical_name(name) or name
            if marker not in markers or (marker == name and marker not in exact):
                markers[marker] = column  # an exact label wins over an alias
            exact.update({name} & {marker})
    return Labelled(markers=markers, positions=positions, outputs=outputs, warnings=warnings)


def _without_common_suffix(split: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Names without the suffix that most known markers carry: LKNE_M is no medial marker where LASI is LASI_M."""
    bare = sum(name.upper() in CANONICAL for _, name in split)
    suffixes = [_SUFFIX.search(name) for _, name in split]
    known = Counter(s[0] for (_, name), s in zip(split, suffixes, strict=True) if s and _stem(name, s[0]) in CANONICAL)
    suffix, count = known.most_common(1)[0] if known else ("", 0)
    if count <= bare:
        return list(split)
    return [(prefix, name.removesuffix(suffix)) for prefix, name in split]


def _stem(name: str, suffix: str) -> str:
    return name.removesuffix(suffix).upper()


def _choose_subject(split: Sequence[tuple[str, str]]) -> tuple[str, tuple[str, ...]]:
    """Prefix of the first subject that wears known markers, and a warning when there are several."""
    subjects = list(dict.fromkeys(prefix for prefix, name in split if prefix and canonical_name(name)))
    if len(subjects) < 2:
        return (subjects[0] if subjects else ""), ()
    return subjects[0], (f"the file holds {len(subjects)} subjects; the markers of the first one are used",)


LOWER_BODY: tuple[str, ...] = tuple(
    side + name for name in ("ASI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE") for side in "LR"
)
"""Markers of the conventional gait model, besides SACR or LPSI with RPSI."""


def require_markers(name: str, markers: Mapping[str, np.ndarray], required: Sequence[str] = LOWER_BODY) -> None:
    """Raises InvalidRecording unless all required markers, and SACR or LPSI with RPSI, are there and seen once.

    Args:
        name: The trial's name, for the message.
        markers: Canonical name to positions [m], laboratory frame, shape (n_frames, 3).
        required: Canonical names.
    """
    seen = {marker for marker, positions in markers.items() if np.isfinite(positions).any()}
    if markers and not seen:
        raise InvalidRecording(f"{name}: no marker is ever visible (all positions are missing); export the trial again")
    missing = [marker for marker in required if marker not in seen]
    if "SACR" not in seen and not {"LPSI", "RPSI"} <= seen:
        missing.append("SACR (or LPSI and RPSI)")
    if not missing:
        return
    there = sorted(markers)
    some = ", ".join(there[:30]) + (" ..." if len(there) > 30 else "")
    raise InvalidRecording(
        f"{name}: required markers are missing: {', '.join(missing)}; the file has: {some or 'none'}; "
        "use the lower-body Plug-in Gait marker set or rename the markers"
    )
