import numpy as np
import pytest

from gaitlab.multibody.subject import PointOnSegment, Segment, SubjectModel

PARENTS = (-1, 0, 1, 2, 0, 4, 5, 0)


def random_segment(generator, index, parent):
    root = generator.normal(size=(3, 3))
    return Segment(
        name=f"segment_{index}",
        parent=parent,
        joint_offset=generator.normal(size=3),
        rotation_offset=generator.normal(size=3),
        mass=generator.uniform(1, 5),
        centre_of_mass=0.1 * generator.normal(size=3),
        inertia=0.1 * (root @ root.T + np.eye(3)),
    )


@pytest.fixture(scope="session")
def random_subject():
    """Eight segments (a trunk beside the legs) with everything random, so that no term can hide."""
    generator = np.random.default_rng(7)
    places = {"right_heel": 3, "right_toe": 3, "left_heel": 6, "left_toe": 6}
    points = {name: PointOnSegment(segment=s, position=generator.normal(size=3)) for name, s in places.items()}
    segments = tuple(random_segment(generator, i, parent) for i, parent in enumerate(PARENTS))
    return SubjectModel(name="random", segments=segments, contacts=points)
