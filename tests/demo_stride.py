"""The first stride of an analysed trial or of a bundled demo walk, ready to be tracked."""

import json
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from gaitlab.mocap.c3d import read_c3d
from gaitlab.pipelines.analyse import Sources, analyse, analyse_files
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


def noisy_demo_request(child, seed, noise):
    """The same with normal noise [m] on every marker coordinate of the walk."""
    folder, random = demo_folder(child), np.random.default_rng(seed)
    walk = read_c3d(folder / "walk1.c3d")
    markers = {name: y + noise * random.standard_normal(y.shape) for name, y in walk.markers.items()}
    noisy = replace(walk, markers=markers)
    return request_of(analyse(read_c3d(folder / "static.c3d"), [noisy], AnalysisOptions(weights=False)).trials[0])


def true_weights(child):
    """Weights for which the demo walk is optimal, shape (n_theta,)."""
    return np.array(json.loads((demo_folder(child) / "truth.json").read_text())["walks"]["walk1"]["weights"])
