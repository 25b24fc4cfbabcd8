import platform

import numpy as np

from gaitlab import __version__
from gaitlab.clinical.environment import environment


def test_versions_and_system_are_told_and_the_machine_is_not_named():
    found = environment(("numpy", "no_such_package"))
    assert found["gaitlab"] == __version__ and found["numpy"] == np.__version__
    assert found["no_such_package"] == "not installed"
    assert platform.node() not in found.values() and int(found["processors"]) >= 1
