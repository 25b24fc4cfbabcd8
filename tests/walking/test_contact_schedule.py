"""Stages against the mechanics of a rigid foot and Coulomb's law."""

from itertools import product

import numpy as np
import pytest

from gaitlab.errors import InvalidRecording, ProblemError
from gaitlab.walking.contact_schedule import ScheduleSettings, contact_stages, thesis_stages

RATE = 100.0
STRIDE = [
    ("heel", "toe", 8), ("flat", "free", 25), ("toe", "free", 12),
    ("toe", "heel", 8), ("free", "flat", 25), ("free", "toe", 12),
]  # fmt: skip


def phases_of(runs):
    return np.concatenate([np.tile([right, left], (n, 1)) for right, left, n in runs])


def stages_of(runs, directions=(0.0, 0.0)):
    phases = phases_of([*runs, ("flat", "toe", 1)])
    return contact_stages(phases, RATE, (0.0, (len(phases) - 1) / RATE), directions=directions)


def foot_jacobian(direction):
    """Velocities of heel and toe (6) of a flat foot by its twist (6)."""
    heel = np.zeros(3)
    toe = 0.2 * np.array([np.cos(direction), np.sin(direction), 0.0])
    cross = [np.cross(np.eye(3), p).T for p in (heel, toe)]  # columns: p x e_k
    return np.vstack([np.hstack([np.eye(3), -c]) for c in cross])


def test_a_normal_stride():
    stages = stages_of(STRIDE)
    assert [stage.label for stage in stages] == [f"{right}-{left}" for right, left, _ in STRIDE]
    assert [stage.n_intervals for stage in stages] == [4, 12, 6, 4, 12, 6]
    np.testing.assert_allclose([stage.duration for stage in stages], [n / RATE for *_, n in STRIDE])
    np.testing.assert_array_equal([stage.data for stage in stages], [[1, 1], [1, 0], [1, 0], [1, 1], [0, 1], [0, 1]])


def test_an_impact_is_a_short_stage_of_its_own_without_soft_landing():
    phases = phases_of([*STRIDE, ("flat", "toe", 1)])
    end = (len(phases) - 1) / RATE
    stages = contact_stages(phases, RATE, (0.0, end), ScheduleSettings(landing="impact", impact_time=0.005))
    impacts = [stage for stage in stages if stage.label.endswith("(impact)")]
    assert [stage.label.split()[0] for stage in impacts] == ["heel-toe", "flat-free", "toe-heel", "free-flat"]
    assert all(stage.duration == 0.005 and stage.n_intervals == 1 and stage.grounded for stage in impacts)
    assert all(stage.landing == () for stage in stages)
    assert sum(stage.duration for stage in stages) == pytest.approx(end)


def test_components_of_a_normal_stride():
    first, second, third, fourth, *_ = stages_of(STRIDE)
    assert first.active == first.landing == (0, 1, 2, 9, 10, 11)
    assert first.grounded == (2, 11) and first.clear == (5, 8)
    assert second.active == (0, 1, 2, 4, 5) and second.landing == (4, 5)
    assert second.grounded == (5,) and second.clear == (8, 11)
    assert third.active == (3, 4, 5) and third.landing == third.grounded == ()
    assert fourth.landing == (6, 7, 8) and fourth.grounded == (8,)


@pytest.mark.parametrize("direction", np.radians([0, 30, -40, 60, 90, 150, -120]))
def test_active_components_of_a_flat_foot_are_independent_and_fix_heel_and_toe(direction):
    (stage,) = stages_of([("flat", "free", 20)], directions=(direction, 0.0))
    values = np.linalg.svd(foot_jacobian(direction)[list(stage.active)], compute_uv=False)
    assert len(values) == 5 == np.linalg.matrix_rank(foot_jacobian(direction))
    assert values[-1] > 0.05


@pytest.mark.parametrize(
    ("before", "after"), [("heel", "flat"), ("toe", "flat"), ("free", "heel"), ("free", "toe"), ("free", "flat")]
)
@pytest.mark.parametrize("direction", np.radians([10, 70]))
def test_what_was_held_and_what_lands_bring_the_foot_to_rest(before, after, direction):
    runs = [(before, "flat", 10), (after, "flat", 10)]
    first, second = stages_of(runs, directions=(direction, 0.0))
    held = [i for i in first.active if i < 6]
    rows = held + [i for i in second.landing if i < 6]
    jacobian = foot_jacobian(direction)
    assert len(rows) == np.linalg.matrix_rank(jacobian[rows])  # none follows from the others
    active = [i for i in second.active if i < 6]
    assert np.linalg.matrix_rank(jacobian[rows + active]) == len(rows)  # all that the stage holds is at rest


@pytest.mark.parametrize("direction", np.radians([0, 70]))
def test_forces_within_the_cone_obey_coulomb(direction):
    settings = ScheduleSettings()
    rng = np.random.default_rng(0)
    for right, left in product(("heel", "flat", "toe"), repeat=2):
        (stage,) = stages_of([(right, left, 20)], directions=(direction, direction))
        f = np.zeros((20000, 12))
        f[:, list(stage.active)] = rng.normal(size=(20000, len(stage.active))) * 0.5
        f[:, 2::3] = np.abs(f[:, 2::3])
        allowed = f[(f @ stage.force_cone.T >= 0).all(axis=1)]
        assert len(allowed) > 20
        for foot in (allowed[:, :6], allowed[:, 6:]):
            x, y, z = foot.reshape(-1, 2, 3).sum(axis=1).T
            assert (np.hypot(x, y) <= settings.friction * z + 1e-12).all()


def test_force_must_push():
    for stage in stages_of(STRIDE):
        for z in (i for i in stage.active if i % 3 == 2):
            assert (stage.force_cone @ -np.eye(12)[z]).min() < 0.0 <= (stage.force_cone @ np.eye(12)[z]).min()


@pytest.mark.parametrize(
    ("stride", "message"), [((0.1, 3.0), "not within"), ((0.1, 0.12), "too short"), ((0.5, 0.1), "too short")]
)
def test_a_stride_that_is_none_is_refused(stride, message):
    with pytest.raises(InvalidRecording, match=message):
        contact_stages(phases_of(STRIDE), RATE, stride)


def test_a_missing_stance_is_refused():
    with pytest.raises(InvalidRecording, match="a foot strike is missing"):
        stages_of([("heel", "toe", 8), ("flat", "free", 30), ("free", "free", 40)])


def test_thesis_stages_are_single_supports_on_toes():
    stages = thesis_stages((0.48, 0.56, 0.2), (24, 28, 10))
    assert [stage.label for stage in stages] == ["toe-free", "free-toe", "toe-free"]
    assert [stage.active for stage in stages] == [(3, 4, 5), (9, 10, 11), (3, 4, 5)]
    assert [stage.landing for stage in stages] == [stage.active for stage in stages]
    assert [stage.clear for stage in stages] == [(11,), (5,), (11,)]
    with pytest.raises(ProblemError, match="three single supports"):
        thesis_stages((0.5, 0.5), (10, 10))  # type: ignore[arg-type]
