import msgspec
import numpy as np
import pytest
from synthetic_output import curve, document

from gaitlab.clinical.cohort_building import CohortSettings, build_cohort
from gaitlab.clinical.comparison import Member, compare, group_bands, tables
from gaitlab.clinical.document import CURVES, Document
from gaitlab.clinical.gait_profile import gait_profile
from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.errors import InvalidReference, NotFound, ProblemError
from gaitlab.report.comparison_figures import figures


def shifted(degrees, gps=None, speed=1.0, description="norms"):
    """A result whose curves all lie higher by that much."""
    written = document()
    for name in CURVES:
        for side in ("left", "right"):
            found = curve(name, side)
            written["kinematics"][name][side] = found | {"mean": [x + degrees for x in found["mean"]]}
    for side in ("left", "right"):
        written["spatiotemporal"][side]["mean"]["speed_m_per_s"] = speed
        written["spatiotemporal"][side]["normalised"]["speed"] = 0.4 * speed
    if gps is not None:
        reference = {"source": "s", "licence": "l", "n": 3, "age_years": None, "speed_bin": "free", "curves": {}}
        scores = {"gvs": {"hip_flexion": gps}, "gps": gps, "gps_sd": 0.2}
        written["scores"] = {"reference": reference | {"description": description}, "left": scores, "gps_overall": gps}
    return msgspec.convert(written, Document)


def member(label, group="", **values):
    return Member(label=label, group=group or label, document=shifted(**values))


def row(comparison, label, quantity, side):
    table = tables(comparison)["quantities"]
    found = next(r for r in table.rows if (r[0], r[2], r[3]) == (label, quantity, side))
    return dict(zip(table.columns, found, strict=True))


def test_differences_stand_beside_the_minimal_difference():
    comparison = compare([member("before", degrees=0.0, gps=9.0), member("after", degrees=0.0, gps=7.0, speed=1.3)])
    gps = row(comparison, "after", "gps_overall", "")
    assert (gps["difference"], gps["minimal_difference"], gps["reaches_minimal_difference"]) == (-2.0, 1.6, True)
    speed = row(comparison, "after", "speed_m_per_s", "left")
    assert speed["difference"] == pytest.approx(0.3) and speed["minimal_difference"] is None


def test_any_result_can_be_the_baseline():
    members = [member("a", degrees=0.0, speed=1.0), member("b", degrees=0.0, speed=1.5)]
    assert row(compare(members, "b"), "a", "speed_m_per_s", "left")["difference"] == -0.5


def test_scores_of_different_references_have_no_difference():
    comparison = compare([member("a", degrees=0.0, gps=9.0), member("b", degrees=0.0, gps=7.0, description="other")])
    assert row(comparison, "b", "gps_overall", "")["difference"] is None
    assert ("b", "b", "differences of scores", "other references than a has") in tables(comparison)["missing"].rows


def forces(value, moments_in="the axes of the segment below the joint"):
    curves = {
        name: {"unit": unit, "left": {"mean": [value] * 101, "sd": [None] * 101, "n_cycles": 1}}
        for name, unit in UNITS.items()
    }
    return {"curves": curves, "moments_in": moments_in, "inertia": "i", "contacts": [], "missing": []}


def with_forces(label, value, **more):
    written = msgspec.to_builtins(shifted(degrees=0.0)) | {"kinetics": forces(value, **more)}
    return Member(label=label, group="one", document=msgspec.convert(written, Document))


def test_kinetics_are_compared_like_angles():
    comparison = compare([with_forces("a", 1.0), with_forces("b", 3.0)])
    band = group_bands(comparison.members)["hip_power", "left"]
    assert (band.mean[0], band.n, band.sd[0]) == (2.0, 2, pytest.approx(np.sqrt(2.0)))
    table = tables(comparison)["bands"]
    units = {row[table.columns.index("curve")]: row[table.columns.index("unit")] for row in table.rows}
    assert (units["hip_power"], units["knee_flexion"]) == ("W/kg", "deg")
    drawn = figures(comparison)["kinetics"]
    assert "in the axes of the segment below the joint" in drawn and "not comparable" not in drawn


def test_moments_in_different_axes_are_told():
    comparison = compare([with_forces("a", 1.0), with_forces("b", 3.0, moments_in="the laboratory")])
    assert "moments are not comparable" in figures(comparison)["kinetics"]


def test_results_without_kinetics_are_told():
    comparison = compare([with_forces("a", 1.0), member("b", degrees=0.0)])
    assert ("b", "b", "kinetics", "the result holds none") in tables(comparison)["missing"].rows
    assert "kinetics" not in figures(compare([member("b", degrees=0.0)]))


def test_a_result_with_nothing_but_curves_is_compared_in_them():
    written = msgspec.to_builtins(shifted(degrees=0.0))
    bare = written | {"weights": None, "scores": None, "inputs": [], "events": [], "spatiotemporal": {}}
    bare = Member(label="bare", group="bare", document=msgspec.convert(bare, Document))
    comparison = compare([member("whole", degrees=0.0), bare])
    assert {"curves", "scores", "spatiotemporal", "weights"} == set(figures(comparison))
    missing = {row[2] for row in tables(comparison)["missing"].rows if row[0] == "bare"}
    assert missing == {"scores", "kinetics", "weights"}


def test_scores_are_drawn_variable_by_variable():
    drawn = figures(compare([member("before", degrees=0.0, gps=9.0), member("after", degrees=2.0, gps=8.0)]))["scores"]
    assert "GVS hip flexion [deg]" in drawn and "GPS overall [deg]" in drawn


def test_curves_that_leave_their_scale_are_told():
    drawn = figures(compare([member("a", degrees=0.0), member("b", degrees=200.0)]))["curves"]
    assert drawn.count("leaves scale:") == len(CURVES)


def test_bands_of_a_group_are_point_by_point():
    band = group_bands([member(str(shift), degrees=shift) for shift in (-1.0, 0.0, 4.0)])["knee_flexion", "left"]
    assert band.n == 3
    assert band.mean == pytest.approx(np.array(curve("knee_flexion", "left")["mean"]) + 1.0)
    assert band.sd == pytest.approx(np.full(101, np.sqrt(7.0)))


def test_a_single_result_brings_the_spread_of_its_cycles():
    band = group_bands([member("alone", degrees=0.0)])["knee_flexion", "left"]
    assert band.n == 1 and band.sd == pytest.approx(np.full(101, 1.5))


def test_weights_keep_their_uncertainty():
    rows = tables(compare([member("a", degrees=0.0)]))["weights"].rows
    assert rows[0][:5] == ("a", "a", "stability", 0.55, 0.04)
    assert rows[3][4] is None and rows[3][6] is False


def test_what_cannot_be_compared_is_refused():
    with pytest.raises(ProblemError, match="nothing to compare"):
        compare([])
    with pytest.raises(ProblemError, match="two results are called a"):
        compare([member("a", degrees=0.0), member("a", degrees=1.0)])
    with pytest.raises(NotFound, match="result 'c' does not exist; available: a"):
        compare([member("a", degrees=0.0)], "c")


SETTINGS = CohortSettings(name="lab", source="a test")


def test_a_cohort_is_mean_and_deviation_between_persons():
    cohort, notes = build_cohort([shifted(d) for d in (-3.0, 0.0, 3.0)], SETTINGS)
    band = cohort.bin("all speeds").curves["hip_flexion"]
    both = np.mean([curve("hip_flexion", side)["mean"] for side in ("left", "right")], axis=0)
    assert not notes and cohort.bins[0].n == 3
    assert band.mean == pytest.approx(both) and band.sd == pytest.approx(np.full(101, 3.0))


def test_a_cohort_knows_how_far_its_own_persons_are_from_its_mean():
    documents = [shifted(d) for d in (-3.0, 3.0)]
    part = build_cohort(documents, SETTINGS)[0].bins[0]
    means = {name: np.array(band.mean) for name, band in part.curves.items()}
    sides = [
        {name: np.array(curve(name, side)["mean"]) + d for name in CURVES}
        for d in (-3.0, 3.0)
        for side in ("left", "right")
    ]
    expected = [gait_profile(side, means).gps for side in sides]
    assert part.gps.mean == pytest.approx(np.mean(expected))


def test_speed_bins_divide_persons_and_small_ones_are_told():
    settings = CohortSettings(name="lab", source="a test", speed_edges=(0.3, 0.5))
    documents = [shifted(0.0, speed=s) for s in (0.5, 1.0, 1.1, 1.5, 1.6, 1.7)]
    cohort, notes = build_cohort(documents, settings)
    assert {part.name: part.n for part in cohort.bins} == {"0.3 to 0.5": 2, "from 0.5": 3}
    assert cohort.default_bin == "from 0.5" and "below 0.3" in notes[0]


def test_one_person_is_no_cohort():
    with pytest.raises(InvalidReference, match="1 of the 2 persons"):
        build_cohort([shifted(0.0)], SETTINGS)


def with_weights(status="solved", **weights):
    found = msgspec.to_builtins(shifted(0.0))
    found["weights"]["criteria"] = [
        {"name": name, "weight": weight, "sd": None, "identifiable": True} for name, weight in weights.items()
    ]
    found["weights"]["solver"]["status"] = status
    return msgspec.convert(found, Document)


def test_weights_of_a_cohort_are_certified_and_of_one_choice_of_criteria():
    documents = [with_weights(a=0.2, b=0.8), with_weights(a=0.4, b=0.6), with_weights(a=1.0)]
    documents.append(with_weights(a=0.9, b=0.1, status="not_converged"))
    part = build_cohort(documents, SETTINGS)[0].bins[0]
    assert part.n == 4 and set(part.weights) == {"a", "b"}
    assert (part.weights["a"].mean, part.weights["a"].sd) == pytest.approx((0.3, np.sqrt(0.02)))
