"""Zero-lag low-pass filter."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from gaitlab.errors import ProblemError
from gaitlab.signal.runs import runs, valid_rows

DOUBLE_PASS = (2.0**0.5 - 1.0) ** 0.25
"""A second-order Butterworth filter run forwards and backwards has its -3 dB point at this fraction of its own cut-off
(Winter, Biomechanics and Motor Control of Human Movement, section 2.2.4.4)."""


def low_pass(x: np.ndarray, rate: float, cut_off: float) -> np.ndarray:
    """Butterworth low-pass without phase lag: second order forwards and backwards, effective order 4.

    |H(f)|^2 = 1/2 at f = cut_off for the double pass, in the pre-warped frequency tan(pi f / rate).

    Args:
        x: Samples, any unit, shape (n, ...). Missing values (NaN) split it into runs; each run is filtered alone.
        rate: Samples per second [Hz].
        cut_off: -3 dB frequency of the double pass [Hz], below rate / 2.

    Returns:
        Filtered samples, shape and NaN of `x`. Runs of one sample are returned as they are.

    Raises:
        ProblemError: The cut-off is not between 0 and half the rate.
    """
    if not 0.0 < cut_off < 0.5 * rate:
        raise ProblemError(f"cut-off {cut_off:g} Hz: it must lie between 0 and half the rate, {0.5 * rate:g} Hz")
    warped = np.tan(np.pi * cut_off / rate) / DOUBLE_PASS
    sections = butter(2, 2.0 * np.arctan(warped) / np.pi, output="sos")
    padding = int(np.ceil(rate / cut_off)) + 6  # the filter's memory: one period of the cut-off
    y = np.full(x.shape, np.nan)
    for start, end in runs(valid_rows(x)):
        length = end - start
        if length == 1:
            y[start] = x[start]
        else:
            y[start:end] = sosfiltfilt(sections, x[start:end], axis=0, padlen=min(padding, length - 1))
    return y
