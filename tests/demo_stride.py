"""The first stride of an analysed trial or of a bundled demo walk, ready to be tracked."""

from functools import lru_cache, partial

from gaitlab.pipelines.analyse import Sources, analyse_files
from gaitlab.pipelines.bundled import demo_folder
from gaitlab.pipelines.model import single_frames
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.weights import WeightsRequest, usable_strides


@lru_cache(maxsize=1)
def _trial(child):
    folder = demo_folder(child)
    sources = Sources(static=folder / "static.c3d", walks=(folder / "walk1.c3d",))
    return analyse_files(sources, AnalysisOptions(weights=False)).trials[0]


def request_of(trial, landing="soft"):
    """What the pipeline would ask of the weights of an analysed trial, with default options."""
    return WeightsRequest(
        recording=trial.recording,
        events=trial.events,
        subject=trial.subject,
        q=trial.motion.q,
        frames=partial(single_frames, trial.subject, trial.recording, trial.kinematics.heading, trial.motion),
        heading=trial.kinematics.heading,
        criteria=AnalysisOptions().criteria,
        seed=0,
        landing=landing,
    )


def first_stride(trial, landing="soft"):
    return usable_strides(request_of(trial, landing))[0][0][1]


def demo_request(child):
    """What the pipeline would ask of the weights of the noise-free demo walk, from its C3D file."""
    return request_of(_trial(child))


def demo_stride(child="demo_cp_child", landing="soft"):
    return first_stride(_trial(child), landing)
