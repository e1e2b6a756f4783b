"""Shape index S = -(2/pi) atan2(k1 + k2, k1 - k2) and curvedness R = sqrt((k1^2 + k2^2) / 2) of a height field.

Normal to the free side (nz > 0): a cap has negative curvatures and S = +1.  At these precisions sqrt(H^2 - K) is harmless.
"""
import arithmetic as ar


def shape(zx, zy, zxx, zxy, zyy):
    """(S, R); S is None where both curvatures vanish exactly."""
    w2 = 1 + zx * zx + zy * zy
    w = ar.sqrt(w2)
    mean = ((1 + zy * zy) * zxx - 2 * zx * zy * zxy + (1 + zx * zx) * zyy) / (2 * w2 * w)
    gauss = (zxx * zyy - zxy * zxy) / (w2 * w2)
    half_gap_squared = mean * mean - gauss
    half_gap = ar.sqrt(half_gap_squared) if half_gap_squared > 0 else ar.exact(0)
    r = ar.sqrt(mean * mean + half_gap * half_gap)
    if r == 0:
        return None, r
    return -2 / ar.pi() * ar.atan2(2 * mean, 2 * half_gap), r


def linspace(low, high, count):
    """Doubles, as numpy's."""
    if count == 1:
        return [low]
    step = (high - low) / (count - 1)
    return [low + i * step for i in range(count - 1)] + [high]


def grid_axis(low, high, inset, count):
    side = high - low
    return linspace(low + inset * side, high - inset * side, count)
