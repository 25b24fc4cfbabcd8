import numpy as np

from gaitlab.transcription.hermite import GAUSS_POINTS, hermite_coefficients


def test_exact_on_cubics():
    """Positions, velocities and accelerations of random cubics, on intervals of several lengths."""
    generator = np.random.default_rng(1)
    s, lengths = generator.uniform(size=5), np.array([0.02, 0.7, 3.0])
    coefficients = hermite_coefficients(s, lengths)
    assert coefficients.shape == (3, 5, 3, 4)
    for h, table in zip(lengths, coefficients, strict=True):
        cubic = np.polynomial.Polynomial(generator.normal(size=4))
        nodes = [cubic(0.0), cubic.deriv()(0.0), cubic(h), cubic.deriv()(h)]
        expected = np.stack([cubic(s * h), cubic.deriv()(s * h), cubic.deriv(2)(s * h)], axis=1)
        np.testing.assert_allclose(table @ nodes, expected, rtol=1e-9, atol=1e-9)


def test_gauss_points_integrate_cubics():
    for power in range(4):
        np.testing.assert_allclose(np.mean(GAUSS_POINTS**power), 1 / (power + 1), rtol=1e-14)
