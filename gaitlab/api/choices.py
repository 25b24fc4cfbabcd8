"""Words that a client may choose from, as the computations know them.

They are written down here a second time, and a test compares them, so that the web process needs no numerical packages
to know them: it starts in a second and never loads a native reader of C3D files.
"""

from typing import Literal

MomentFrame = Literal["distal", "proximal", "joint", "laboratory"]
InertiaConvention = Literal["subject", "plug-in gait"]
StaticOffsets = Literal["computed", "file"]
Landing = Literal["soft", "impact"]
CriterionName = Literal[
    "lateral_stability",
    "torque",
    "hip_adduction_torque",
    "hip_rotation_torque",
    "mechanical_power",
    "peak_joint_moment",
]
DEFAULT_CRITERIA: tuple[CriterionName, ...] = (
    "lateral_stability",
    "torque",
    "hip_adduction_torque",
    "hip_rotation_torque",
)
ReportPage = Literal[
    "front",
    "examination",
    "kinematics",
    "consistency",
    "kinetics",
    "emg",
    "spatiotemporal",
    "scores",
    "weights",
    "walk",
    "stills",
    "quality",
    "provenance",
]
Palette = Literal["standard", "green", "safe"]
NormName = Literal["schwartz2008", "none"]
"""Bundled norms, or none."""
