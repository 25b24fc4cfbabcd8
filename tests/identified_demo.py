"""The optimal gait of a demo stride for equal weights, as an identified gait; no search for weights is needed."""

from functools import lru_cache

import numpy as np
from demo_stride import demo_stride

from gaitlab.walking.identification import IdentificationSettings, WalkLevel
from gaitlab.walking.identified_gait import identified_gait
from gaitlab.walking.tracking import track

EQUAL = np.full(4, 0.25)


@lru_cache(maxsize=1)
def identified_demo(child="demo_able_bodied_child"):
    level = WalkLevel(track(demo_stride(child)), IdentificationSettings())
    return identified_gait(level.from_tracking(EQUAL), EQUAL)
