"""Rows of results; that they are written is tested with the jobs that make them."""

import pytest

from gaitlab.jobs.results import media_type


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("a/result.json", "application/json"),
        ("walk.npz", "application/x-npz"),
        ("x.unknown", "application/octet-stream"),
    ],
)
def test_media_types(name, kind):
    assert media_type(name) == kind
