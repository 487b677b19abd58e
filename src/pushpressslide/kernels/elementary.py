"""Elementary functions that kernels call in place of those of ``math``.

In Python they are those of ``math``. In compiled code they are arithmetic without
branches, accurate to 1e-15 for angles up to a million radians. A compiled loop
therefore calls no library, and can process several rows at once. The coefficients are
those of the Cephes Mathematical Library (S. Moshier, 1984 to 2000).
"""

from __future__ import annotations

import math

import numpy as np

from pushpressslide.kernels.kernel import compiled_as, kernel

TURN = 2.0 * math.pi
HALF_PI = 0.5 * math.pi
EIGHTH = math.tan(math.pi / 8.0)
# pi/2 in three parts, the first two short: products with whole numbers are exact
HALF_PI_1 = 1.57079625129699707031
HALF_PI_2 = 7.54978941586159635336e-8
HALF_PI_3 = 5.39030285815811905290e-15


@kernel
def quick_arctangent2(y: float, x: float) -> float:
    """Angle [rad] of (x, y) in [-pi, pi]. Zero for a zero vector."""
    a = abs(y)
    b = abs(x)
    steep = a > b
    low = b if steep else a
    high = a if steep else b
    past = low > EIGHTH * high  # the angle is nearer to pi/4 than to 0
    top = low - high if past else low
    bottom = low + high if past else high
    t = top / (1.0 if bottom == 0.0 else bottom)
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
    angle = 0.25 * math.pi + angle if past else angle
    angle = HALF_PI - angle if steep else angle
    angle = math.pi - angle if x < 0.0 else angle
    return -angle if y < 0.0 else angle


@kernel
def quick_arctangent(slope: float) -> float:
    """Angle [rad] of a slope, in [-pi/2, pi/2]."""
    return quick_arctangent2(slope, 1.0)


@kernel
def quick_arccosine(cosine: float) -> float:
    """Angle [rad] of a cosine, in [0, pi]."""
    return quick_arctangent2(np.sqrt((1.0 - cosine) * (1.0 + cosine)), cosine)


@kernel
def quick_sine(angle: float) -> float:
    """Sine of an angle [rad]."""
    quarters = np.floor(angle * (2.0 / math.pi) + 0.5)
    return sine_of_quarters(quarters, rest_of(angle, quarters))


@kernel
def quick_cosine(angle: float) -> float:
    """Cosine of an angle [rad]."""
    quarters = np.floor(angle * (2.0 / math.pi) + 0.5)
    return sine_of_quarters(quarters + 1.0, rest_of(angle, quarters))


@kernel
def quick_tangent(angle: float) -> float:
    """Tangent of an angle [rad]."""
    return quick_sine(angle) / quick_cosine(angle)


@kernel
def rest_of(angle: float, quarters: float) -> float:
    """Remainder of an angle [rad] after a number of quarter turns."""
    rest = angle - quarters * HALF_PI_1
    return (rest - quarters * HALF_PI_2) - quarters * HALF_PI_3


@kernel
def sine_of_quarters(quarters: float, rest: float) -> float:
    """Sine of a number of quarter turns plus a ``rest`` [rad] up to pi/4."""
    sine, cosine = sine_and_cosine(rest)
    quarter = quarters - 4.0 * np.floor(0.25 * quarters)  # 0 to 3, of the circle
    value = cosine if (quarter == 1.0) | (quarter == 3.0) else sine
    return -value if quarter >= 2.0 else value


@kernel
def sine_and_cosine(rest: float) -> tuple[float, float]:
    """Sine and cosine of an angle [rad] up to pi/4."""
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


@kernel
def quick_hypotenuse(x: float, y: float) -> float:
    """Length of a vector."""
    a = abs(x)
    b = abs(y)
    low = b if a > b else a
    high = a if a > b else b
    share = low / (1.0 if high == 0.0 else high)
    return float(high * np.sqrt(1.0 + share * share))


@kernel
def quick_turn_part(angle: float) -> float:
    """Angle [rad] modulo a whole turn, in [0, 2 pi]."""
    return float(angle - TURN * np.floor(angle * (1.0 / TURN)))


@kernel
def quick_rounded_down(number: float) -> float:
    """Largest whole number not above the argument."""
    return float(np.floor(number))


@kernel
def quick_square(number: float) -> float:
    """Square of a number."""
    return number * number


@compiled_as(quick_arctangent2)
def arctangent2(y: float, x: float) -> float:
    """Angle [rad] of (x, y) in [-pi, pi]."""
    return math.atan2(y, x)


@compiled_as(quick_arctangent)
def arctangent(slope: float) -> float:
    """Angle [rad] of a slope, in [-pi/2, pi/2]."""
    return math.atan(slope)


@compiled_as(quick_arccosine)
def arccosine(cosine: float) -> float:
    """Angle [rad] of a cosine, in [0, pi]."""
    return math.acos(cosine)


@compiled_as(quick_sine)
def sine(angle: float) -> float:
    """Sine of an angle [rad]."""
    return math.sin(angle)


@compiled_as(quick_cosine)
def cosine(angle: float) -> float:
    """Cosine of an angle [rad]."""
    return math.cos(angle)


@compiled_as(quick_tangent)
def tangent(angle: float) -> float:
    """Tangent of an angle [rad]."""
    return math.tan(angle)


@compiled_as(quick_hypotenuse)
def hypotenuse(x: float, y: float) -> float:
    """Length of a vector."""
    return math.hypot(x, y)


@compiled_as(quick_turn_part)
def turn_part(angle: float) -> float:
    """Angle [rad] modulo a whole turn, in [0, 2 pi)."""
    return angle % TURN


@compiled_as(quick_rounded_down)
def rounded_down(number: float) -> float:
    """Largest whole number not above the argument."""
    return math.floor(number)


@compiled_as(quick_square)
def square(number: float) -> float:
    """Square of a number."""
    return number**2
