"""Linear envelope of an electromyogram."""

import numpy as np

from gaitlab.signal.filtering import low_pass

BAND = (20.0, 450.0)  # Hz; surface EMG (De Luca et al. 2010, J Biomech 43:1573)
SMOOTH = 6.0  # Hz


def linear_envelope(x: np.ndarray, rate: float) -> np.ndarray:
    """Band-pass, rectify, low-pass, all without phase lag: LP_6(|LP_450(x - LP_20(x))|).

    Args:
        x: Raw signal, any unit, shape (n,).
        rate: Samples per second [Hz], above 100; a rate below 1000 leaves the upper end of the band to the recorder.

    Returns:
        Envelope, unit of `x`, not negative, shape (n,).
    """
    moving = x - low_pass(x, rate, BAND[0])
    if BAND[1] < 0.45 * rate:
        moving = low_pass(moving, rate, BAND[1])
    return np.maximum(low_pass(np.abs(moving), rate, SMOOTH), 0.0)
