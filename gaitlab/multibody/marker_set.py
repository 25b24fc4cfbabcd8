"""Which segment carries which marker: conventional gait model, Oxford foot model, CGM2 and medial markers."""

PELVIS = ("LASI", "RASI", "SACR", "LPSI", "RPSI")
THIGH = ("THI", "KNE", "KNM", "MKNE", "THAP", "THAD", "PAT")
SHANK = ("TIB", "ANK", "MMA", "MED", "MANK", "HFB", "TUB", "SHN", "TIAP", "TIAD")
FOOT = ("HEE", "TOE", "CPG", "PCA", "LCA", "STL", "NAV", "P1M", "D1M", "P5M", "D5M", "FMH", "SMH", "VMH")
TRUNK = ("C7", "T2", "T6", "T10", "T12", "RBAK", "CLAV", "STRN")


def _segment_of_marker() -> dict[str, str]:
    segments = dict.fromkeys(PELVIS, "pelvis") | dict.fromkeys(TRUNK, "trunk")
    for side, letter in (("left", "L"), ("right", "R")):
        for kind, names in (("thigh", THIGH), ("shank", SHANK), ("foot", FOOT)):
            segments |= {letter + name: f"{side}_{kind}" for name in names}
    return segments


SEGMENT_OF_MARKER = _segment_of_marker()
"""Canonical marker name to the name of its segment. Head, arms, toes and alignment devices move by themselves."""

CONVENTIONAL = frozenset(PELVIS) | {side + name for side in "LR" for name in ("THI", "KNE", "TIB", "ANK", "HEE", "TOE")}
"""Markers of the conventional gait model."""
