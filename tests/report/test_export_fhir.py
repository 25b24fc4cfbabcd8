import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from exported_trial import exported_trial
from synthetic_output import document as synthetic_document
from synthetic_output import weights

from gaitlab.clinical.document import read_document
from gaitlab.clinical.kinetics_document import UNITS
from gaitlab.report.export_fhir import Header, export_fhir, fhir_bundle

SCHEMA = json.loads((Path(__file__).parent / "fhir_r4_observations.schema.json").read_text())
VALIDATOR = jsonschema.Draft6Validator(SCHEMA)
HEADER = Header(seed="s", status="final", version="1", pseudonym="P01", date="2026-11-22")


def averages(value):
    return {"mean": np.full(101, value).tolist(), "sd": [None] * 101, "n_cycles": 1}


def scores():
    reference = {"description": "Cohort, n = 9", "source": "s", "licence": "l", "n": 9, "age_years": None}
    reference |= {"speed_bin": "free", "curves": {}, "spatiotemporal": {"speed_m_per_s": {"mean": 1.2, "sd": 0.1}}}
    side = {"gvs": {"knee_flexion": 8.0}, "gps": 7.5, "gps_sd": 0.5, "n_cycles": 2, "gdi": 88.0}
    return {"reference": reference, "left": side, "right": None, "gps_overall": 7.0, "gdi_reference": "basis"}


@pytest.fixture
def document(tmp_path):
    kinetics = {"curves": {name: {"unit": unit, "left": averages(0.5)} for name, unit in UNITS.items()}}
    kinetics |= {
        "moments_in": "the joint coordinate system",
        "inertia": "i",
        "contacts": [],
        "missing": [],
    }
    folder = exported_trial(tmp_path / "result", changed={"scores": scores(), "kinetics": kinetics})
    return read_document(folder / "result.json")


def by_code(bundle):
    resources = [entry["resource"] for entry in bundle["entry"]]
    return {resource["code"]["coding"][-1]["code"]: resource for resource in resources}


def test_the_bundle_is_valid(document):
    bundle = json.loads(json.dumps(fhir_bundle(document, HEADER)))
    assert list(VALIDATOR.iter_errors(bundle)) == []
    assert len(by_code(bundle)) == len(bundle["entry"]) > 70  # every code once
    # The published schema does not demand the status, the specification does (cardinality 1..1).
    assert {entry["resource"]["status"] for entry in bundle["entry"]} == {"final"}


@pytest.mark.parametrize(
    "breaks",
    [
        lambda r: r.pop("code"),
        lambda r: r.update(status="done"),
        lambda r: r.update(valueQuantity={"value": "1.2"}),
        lambda r: r.update(speed=1.2),
    ],
)
def test_the_schema_finds_mistakes(document, breaks):
    bundle = json.loads(json.dumps(fhir_bundle(document, HEADER)))
    bundle["entry"] = bundle["entry"][:2]
    assert not list(VALIDATOR.iter_errors(bundle))
    breaks(bundle["entry"][0]["resource"])
    assert list(VALIDATOR.iter_errors(bundle))


def test_a_number_has_unit_side_spread_and_norm(document):
    speed = by_code(fhir_bundle(document, HEADER))["spatiotemporal.speed_m_per_s.left"]
    assert speed["valueQuantity"] == {"value": 1.1, "unit": "m/s", "system": "http://unitsofmeasure.org", "code": "m/s"}
    assert (speed["bodySite"]["text"], speed["status"], speed["effectiveDateTime"]) == (
        "left leg",
        "final",
        "2026-11-22",
    )
    assert [c["code"]["text"] for c in speed["component"]] == ["standard deviation", "number of cycles"]
    (expected,) = speed["referenceRange"]
    assert expected["low"]["value"] == pytest.approx(1.1) and "Cohort, n = 9" in expected["text"]


def test_body_weight_and_height_have_loinc_codes(document):
    found = by_code(fhir_bundle(document, HEADER))
    assert [found[code]["code"]["coding"][0]["code"] for code in ("body-mass", "body-height")] == ["29463-7", "8302-2"]


def test_a_curve_is_sampled_data_with_its_convention(document):
    found = by_code(fhir_bundle(document, HEADER))
    samples = found["kinematics.knee_flexion.left"]["valueSampledData"]
    read = [float(word) for word in samples["data"].split()]
    assert read == pytest.approx(document.kinematics["knee_flexion"].left.mean, abs=1e-5)
    assert samples["period"] == pytest.approx(11.0)  # ms: a stride of 1.1 s in 100 parts
    moment = found["kinetics.hip_extensor_moment.left"]
    assert (
        "Flexor / Extensor" in moment["method"]["text"] and "internal, in the joint coord" in moment["method"]["text"]
    )
    assert moment["component"][0]["valueSampledData"]["data"].split() == ["E"] * 101


def test_a_weight_without_certificate_is_never_final(tmp_path):
    written = synthetic_document() | {"weights": weights("not_converged")}
    document = read_document(exported_trial(tmp_path, changed=written) / "result.json")
    weight = by_code(fhir_bundle(document, HEADER))["criterion-weight.torque"]
    assert weight["status"] == "preliminary" and weight["note"][0]["text"].startswith("Not converged")


def test_the_folder_gives_pseudonym_date_and_state(tmp_path):
    folder = exported_trial(tmp_path / "result")
    (folder / "examination.json").write_text('{"patient": {"pseudonym": "P07"}, "session": {"date": "2026-03-01"}}')
    export_fhir(folder, tmp_path / "fhir.json")
    first = json.loads((tmp_path / "fhir.json").read_text())["entry"][0]["resource"]
    assert first["subject"]["identifier"]["value"] == "P07" and first["effectiveDateTime"] == "2026-03-01"
    assert first["status"] == "preliminary"  # no report is signed


def test_without_an_examination_nobody_is_named(document):
    plain = Header(seed="s", status="preliminary", version="1")
    assert all("subject" not in resource for resource in by_code(fhir_bundle(document, plain)).values())


def test_the_same_result_gets_the_same_identifiers(document):
    assert fhir_bundle(document, HEADER) == fhir_bundle(document, HEADER)
    other = Header(seed="t", status="final", version="1")
    assert fhir_bundle(document, HEADER)["entry"][0]["fullUrl"] != fhir_bundle(document, other)["entry"][0]["fullUrl"]
