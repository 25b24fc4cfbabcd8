"""Contact phases and stages of six real walks: against the force plates, and against what walking looks like."""

import numpy as np
import pytest

from gaitlab.mocap.cycles import full_strides, visible_strides
from gaitlab.multibody.kinematics import point_positions
from gaitlab.pipelines.analyse import Sources, analyse_files
from gaitlab.pipelines.gait_frame import lab_to_gait
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.walk_arrays import plate_at_frames
from gaitlab.walking.contact_phases import GaitEvents, contact_phases, foot_directions
from gaitlab.walking.contact_schedule import contact_stages

pytestmark = pytest.mark.shared_data


@pytest.fixture(scope="module")
def walks(shared_data):
    """Pairs (trial, phases) of all children's straight walks."""
    found = []
    for walk in sorted((shared_data / "children").glob("*/straight*.c3d")):
        sources = Sources(walks=(walk,), static=next(walk.parent.glob("static*.c3d")))
        trial = analyse_files(sources, AnalysisOptions(weights=False)).trials[0]
        found.append(
            (trial, contact_phases(trial.subject, trial.motion.q, trial.recording.rate, GaitEvents(feet=trial.events)))
        )
    return found


def test_the_centre_of_pressure_lies_under_the_part_that_stands(walks):
    """Shares of the way from heel to toe point; the truth is the plates', which the parts do not use."""
    for trial, phases in walks:
        shares = pressure_shares(trial, phases)
        assert np.percentile(shares["heel"], 90) < 0.4, trial.name
        assert 0.4 < np.median(shares["flat"]) < 0.9, trial.name
        assert np.percentile(shares["toe"], 10) > 0.95, trial.name


def pressure_shares(trial, phases):
    q, rate = trial.motion.q, trial.recording.rate
    points = point_positions(trial.subject, trial.subject.contacts, q)
    found = {"heel": [], "flat": [], "toe": []}
    for plate in trial.recording.force_plates:
        force, centre = plate_at_frames(plate, rate, len(q))
        for k, side in enumerate(("right", "left")):
            along = (points[f"{side}_toe"] - points[f"{side}_heel"])[:, :2]
            offset = (lab_to_gait(centre, trial.kinematics.heading) - points[f"{side}_heel"])[:, :2]
            share = (offset * along).sum(axis=1) / (along**2).sum(axis=1)
            aside = np.linalg.norm(offset - share[:, None] * along, axis=1)
            under = (np.abs(force[:, 2]) > 60.0) & (aside < 0.08) & (np.abs(share - 0.5) < 1.0)
            for state, values in found.items():
                values.extend(share[under & (phases[:, k] == state)])
    return found


def test_stages_of_every_stride_look_like_walking(walks):
    for trial, phases in walks:
        rate, events = trial.recording.rate, trial.events
        directions = foot_directions(trial.subject, trial.motion.q, phases)
        for stride in visible_strides(trial.recording, full_strides(trial.name, events))[0]:
            stages = contact_stages(phases, rate, (stride.start, stride.end), directions=directions)
            durations = np.array([stage.duration for stage in stages])
            stands = np.array([stage.data for stage in stages])
            lone = np.array([durations[stands @ [1, 2] == k].sum() for k in (1, 2)]) / durations.sum()
            assert durations.sum() == pytest.approx(stride.duration, abs=1.01 / rate)
            assert durations.min() >= 0.04 - 1e-9
            assert lone.min() > 0.36 and lone.max() < 0.46, trial.name
            edges = np.concatenate([[0.0], np.cumsum(durations)]) + round(stride.start * rate) / rate
            inside = [event.time for event in events if stride.start < event.time < stride.end]
            assert max(np.abs(edges - time).min() for time in inside) < 1.51 / rate, trial.name
