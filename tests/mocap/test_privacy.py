import numpy as np
import pytest
from raw_file import raw_recording

from gaitlab.mocap.privacy import privacy_warnings


@pytest.mark.parametrize(
    ("labels", "parameters", "place"),
    [
        (("A",), {"SUBJECTS": {"NAMES": ("Jane Doe",)}}, "SUBJECTS:NAMES"),
        (("Jane:LASI",), {}, "the prefix of the marker labels"),
        (("A",), {"PATIENT": {"BIRTH_DATE": ("1.2.2003",)}}, "PATIENT:BIRTH_DATE"),
        (("A",), {"CLINIC": {"PATIENT_ID": np.array([4711.0])}}, "CLINIC:PATIENT_ID"),
    ],
)
def test_personal_data_is_noticed_but_not_shown(labels, parameters, place):
    (warning,) = privacy_warnings(raw_recording(labels=labels, parameters=parameters))
    assert place in warning
    assert not any(secret in warning for secret in ("Jane", "Doe", "2003", "4711"))


@pytest.mark.parametrize("names", [(), ("",), ("HC002D",), ("P01_static",), ("1111111111",)])
def test_codes_are_no_names(names):
    assert privacy_warnings(raw_recording(parameters={"SUBJECTS": {"NAMES": names, "BIRTH_DATE": ("",)}})) == ()
