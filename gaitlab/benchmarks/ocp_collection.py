"""The optimal control benchmarks by name."""

from collections.abc import Callable, Mapping

from ..errors import NotFound
from .definition import Benchmark
from .polar_robot import polar_robot
from .polar_robot_lifted import polar_robot_lifted
from .rayleigh import rayleigh
from .reeds_shepp import reeds_shepp, reeds_shepp_with_controls
from .rocket_car import rocket_car

BENCHMARKS: Mapping[str, Callable[[], Benchmark]] = {
    "rocket-car": rocket_car,
    "rayleigh": rayleigh,
    "reeds-shepp": reeds_shepp,
    "reeds-shepp-controls": reeds_shepp_with_controls,
    "polar-robot": polar_robot,
    "polar-robot-lifted": polar_robot_lifted,
}


def benchmark(name: str) -> Benchmark:
    """Build a benchmark.

    Raises:
        NotFound: There is none of this name.
    """
    if name not in BENCHMARKS:
        raise NotFound("benchmark", name, BENCHMARKS)
    return BENCHMARKS[name]()
