"""The demo children as a laboratory sees them: a static trial, and the model that is built from it.

The walks are simulated with that model, so that the body behind a recording is the one that the analysis finds.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..inverse.conventional import joint_kinematics
from ..inverse.static import calibrate_subject
from ..mocap.recording import Recording
from ..multibody.presets import ABLE_BODIED_CHILD, CP_CHILD
from ..multibody.scaling import SubjectSettings
from ..multibody.subject import SubjectModel
from .demo_markers import body_parameters, standing_coordinates, with_markers
from .demo_patterns import GaitPattern
from .demo_recording import static_recording
from .model import person_model

HEIGHTS = {child.name: child.height for child in (CP_CHILD, ABLE_BODIED_CHILD)}
"""[m]"""


@dataclass(frozen=True, kw_only=True)
class DemoSubject:
    """A demo child."""

    preset: SubjectModel
    """The body of the thesis's tables, with markers."""
    parameters: Mapping[str, float]
    """Measurements as a laboratory would note them, SI units."""
    standing: np.ndarray
    """Coordinates of the preset in the static trial [m, rad], shape (n_q,)."""
    static: Recording
    model: SubjectModel
    """What the analysis builds from the static trial."""


def demo_subject(pattern: GaitPattern) -> DemoSubject:
    """The child of a pattern."""
    preset = pattern.preset()
    parameters = body_parameters(preset, HEIGHTS[preset.name])
    preset = with_markers(preset, parameters, pattern.tilt)
    standing = standing_coordinates(preset, pattern)
    static = static_recording(preset, standing, parameters)
    calibration = calibrate_subject(static, static, {})
    model = person_model(static, joint_kinematics(static, calibration), calibration.parameters, SubjectSettings())
    return DemoSubject(preset=preset, parameters=parameters, standing=standing, static=static, model=model)
