"""Arctangent, sine and cosine as arithmetic, so that a compiled loop may work on several
rows at once: it calls no library.

NumPy has its own; ``arctan2``, ``sin`` and ``cos`` are these, and in a compiled loop the
functions below that do the same to 1e-15. The coefficients are those of the Cephes
Mathematical Library (S. Moshier, 1984 to 2000).
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.core.formulas import Column, compiled_as, where

EIGHTH = math.tan(math.pi / 8.0)
# pi/2 in three parts, the first two short: products with whole numbers are exact
HALF_PI_1 = 1.57079625129699707031
HALF_PI_2 = 7.54978941586159635336e-8
HALF_PI_3 = 5.39030285815811905290e-15


def quick_arctan2(y: Column, x: Column) -> Column:
    """Return the angle [rad] of (x, y) in [-pi, pi]; zero for no length."""
    a = np.abs(y)
    b = np.abs(x)
    steep = a > b
    low = where(steep, b, a)
    high = where(steep, a, b)
    past = low > EIGHTH * high  # the angle is nearer to pi/4 than to 0
    top = where(past, low - high, low)
    bottom = where(past, low + high, high)
    t = top / where(bottom == 0.0, 1.0, bottom)
    z = t * t
    zz = z * z
    # both polynomials in pairs of terms, which wait less for each other
    p = -8.750608600031904122785e-1 * z - 1.615753718733365076637e1
    p = p * zz + (-7.500855792314704667340e1 * z - 1.228866684490136173410e2)
    p = p * z - 6.485021904942025371773e1
    q = z + 2.485846490142306297962e1
    q = q * zz + (1.650270098316988542046e2 * z + 4.328810604912902668951e2)
    q = q * zz + (4.853903996359136964868e2 * z + 1.945506571482613964425e2)
    angle = t + t * z * p / q
    angle = where(past, 0.25 * math.pi + angle, angle)
    angle = where(steep, 0.5 * math.pi - angle, angle)
    angle = where(x < 0.0, math.pi - angle, angle)
    return where(y < 0.0, -angle, angle)


def quick_sin(angle: Column) -> Column:
    """Return the sine, of angles [rad] up to a million."""
    quarters = np.floor(angle * (2.0 / math.pi) + 0.5)
    return sine_of_quarters(quarters, rest_of(angle, quarters))


def quick_cos(angle: Column) -> Column:
    """Return the cosine, of angles [rad] up to a million."""
    quarters = np.floor(angle * (2.0 / math.pi) + 0.5)
    return sine_of_quarters(quarters + 1.0, rest_of(angle, quarters))


def rest_of(angle: Column, quarters: Column) -> Column:
    """Return an angle less so many quarters of a turn."""
    rest = angle - quarters * HALF_PI_1
    return (rest - quarters * HALF_PI_2) - quarters * HALF_PI_3


def sine_of_quarters(quarters: Column, rest: Column) -> Column:
    """Return the sine of so many quarters of a turn and a ``rest`` up to pi/4."""
    sine, cosine = sine_and_cosine(rest)
    quarter = quarters - 4.0 * np.floor(0.25 * quarters)  # 0 to 3, of the circle
    value = where((quarter == 1.0) | (quarter == 3.0), cosine, sine)
    return where(quarter >= 2.0, -value, value)


def sine_and_cosine(rest: Column) -> tuple[Column, Column]:
    """Return sine and cosine of an angle [rad] up to pi/4."""
    z = rest * rest
    zz = z * z
    # both polynomials in pairs of terms, which wait less for each other
    s = 1.58962301576546568060e-10 * z - 2.50507477628578072866e-8
    s = s * zz + (2.75573136213857245213e-6 * z - 1.98412698295895385996e-4)
    s = s * zz + (8.33333333332211858878e-3 * z - 1.66666666666666307295e-1)
    c = -1.13585365213876817300e-11 * z + 2.08757008419747316778e-9
    c = c * zz + (-2.75573141792967388112e-7 * z + 2.48015872888517045348e-5)
    c = c * zz + (-1.38888888888730564116e-3 * z + 4.16666666666665929218e-2)
    return rest + rest * z * s, 1.0 - 0.5 * z + zz * c


@compiled_as(quick_arctan2)
def arctan2(y: Column, x: Column) -> Column:
    """Return the angle [rad] of (x, y) in [-pi, pi]."""
    return np.arctan2(y, x)


@compiled_as(quick_sin)
def sin(angle: Column) -> Column:
    """Return the sine of an angle [rad]."""
    return np.sin(angle)


@compiled_as(quick_cos)
def cos(angle: Column) -> Column:
    """Return the cosine of an angle [rad]."""
    return np.cos(angle)
