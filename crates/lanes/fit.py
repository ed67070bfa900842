#!/usr/bin/env python3
"""Prints the coefficients of src/math.rs: near-minimax fits, highest power first. Needs numpy and mpmath.

Each is a polynomial p in z on [low, high] that makes `p(z) * weight(z)` as near to `f(z) * weight(z)` as can be in the largest
deviation, found by least squares whose weights follow the deviation [Lawson 1961].
"""
import mpmath as mp
import numpy as np

mp.mp.dps = 40


def fit(name, f, low, high, degree, weight):
    middle, half = (low + high) / 2, (high - low) / 2
    z = middle - half * np.cos(np.linspace(0, np.pi, 600))
    value = np.array([float(f(mp.mpf(float(x)))) for x in z])
    scale = np.array([float(weight(x)) for x in z])
    basis = np.polynomial.chebyshev.chebvander((z - middle) / half, degree) * scale[:, None]
    lawson = np.ones_like(z)
    best = np.inf
    for _ in range(300):
        root = np.sqrt(lawson)
        c, *_ = np.linalg.lstsq(basis * root[:, None], value * scale * root, rcond=None)
        deviation = np.abs(basis @ c - value * scale)
        if deviation.max() < best:
            best, kept = deviation.max(), c
        lawson *= deviation + 1e-300
        lawson /= lawson.max()
    series = np.polynomial.chebyshev.Chebyshev(kept, domain=[low, high])
    powers = series.convert(kind=np.polynomial.Polynomial).coef[::-1]
    print(f"{name}: deviation {best:.1e}")
    print("   ", ", ".join(str(np.float32(c)) for c in powers))


tiny = 1e-9  # Keeps away from the quotients 0/0.
quarter = float(mp.pi / 4)
fit("sin", lambda z: (mp.sin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, tiny, quarter**2, 2, lambda z: z)
fit("cos", lambda z: (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2, tiny, quarter**2, 2, lambda z: z**2)
fit("exp", lambda z: (mp.exp(z) - 1 - z) / z**2 if z else mp.mpf(0.5), -0.3466, 0.3466, 4, lambda z: z**2)
fit("ln", lambda z: (mp.log(1 + z) - z + z**2 / 2) / z**3 if abs(z) > 1e-8 else mp.mpf(1) / 3,
    float(mp.sqrt(0.5)) - 1, float(mp.sqrt(2)) - 1, 8, lambda z: z**2)
fit("atanh", lambda z: (mp.atanh(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, tiny, 0.02944, 3, lambda z: z)
fit("atan", lambda z: (mp.atan(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, tiny, 0.41422**2, 3, lambda z: z)
fit("asin", lambda z: (mp.asin(mp.sqrt(z)) / mp.sqrt(z) - 1) / z, tiny, 0.25, 4, lambda z: z)
fit("erf", lambda z: mp.erf(mp.sqrt(z)) / mp.sqrt(z), tiny, 0.9, 6, lambda z: 1)
fit("erfc", lambda z: -mp.log(mp.erfc(z)) / z, 0.9, 4.0, 8, lambda z: z * mp.erfc(z) / mp.erf(z))


def erf_inv_by(unit):
    """erf_inv(x) / x, where `unit` gives 1 - |x|."""
    def value(z):
        d = unit(z)
        return mp.erfinv(1 - d) / (1 - d) if d < 1 else mp.sqrt(mp.pi) / 2
    return value


def complement(w):
    """1 - x where w = -ln(1 - x²)."""
    rest = mp.exp(-w)
    return rest / (1 + mp.sqrt(1 - rest))


fit("erf_inv, middle", lambda z: erf_inv_by(complement)(z + 2.5), -2.5, 2.5, 10, lambda z: 1)
fit("erf_inv, tail", lambda z: erf_inv_by(complement)((z + 3)**2), 5**0.5 - 3, 4.1 - 3, 10, lambda z: 0.3)
