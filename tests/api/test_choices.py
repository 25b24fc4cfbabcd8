"""The words that the web process knows by heart are those of the computations."""

from typing import get_args

import pytest

from gaitlab.api import choices, quantities
from gaitlab.inverse import leg_kinetics
from gaitlab.pipelines import options
from gaitlab.pipelines.references import bundled_norms
from gaitlab.report import colours, pages
from gaitlab.walking import contact_schedule, criteria
from gaitlab.walking import quantities as walking_quantities


@pytest.mark.parametrize(
    ("here", "there"),
    [
        (choices.MomentFrame, get_args(leg_kinetics.MomentFrame)),
        (choices.InertiaConvention, get_args(leg_kinetics.InertiaConvention)),
        (choices.StaticOffsets, get_args(options.StaticOffsets)),
        (choices.Landing, get_args(contact_schedule.Landing)),
        (choices.CriterionName, tuple(criteria.ALL)),
        (choices.ReportPage, pages.KEYS),
        (choices.Palette, get_args(colours.Palette)),
    ],
)
def test_words_are_the_same(here, there):
    assert set(get_args(here)) == set(there)


def test_the_defaults_are_the_same():
    assert choices.DEFAULT_CRITERIA == criteria.THESIS


def test_bundled_norms_are_there():
    assert [bundled_norms(name).is_file() for name in get_args(choices.NormName) if name != "none"] == [True]


def test_quantities_of_predictions_are_the_same():
    known = walking_quantities.QUANTITIES.values()
    assert {name: (q.unit, q.lowest, q.highest, q.relative_to) for name, q in quantities.QUANTITIES.items()} == {
        q.name: (q.unit, q.lowest, q.highest, q.relative_to) for q in known
    }
