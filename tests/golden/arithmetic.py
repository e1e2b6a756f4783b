"""Numbers of a chosen precision: MPFR through gmpy2 where it is installed, mpmath's own mpf where it is not.

Both round correctly at the precision set here, so that the golden files do not depend on which one ran (gmpy2 is some
ten times faster).  A double converts exactly.
"""
import mpmath

try:
    import gmpy2
except ImportError:
    gmpy2 = None


def set_digits(digits):
    """Work with at least this many decimal digits from here on."""
    mpmath.mp.dps = digits
    if gmpy2 is not None:
        gmpy2.get_context().precision = mpmath.mp.prec


def exact(value):
    """A double (or a small integer), exactly."""
    return gmpy2.mpfr(value) if gmpy2 is not None else mpmath.mpf(value)


def decimal(text):
    """A decimal numeral, rounded once at the working precision."""
    return gmpy2.mpfr(text) if gmpy2 is not None else mpmath.mpf(text)


def sqrt(value):
    return gmpy2.sqrt(value) if gmpy2 is not None else mpmath.sqrt(value)


def atan2(y, x):
    return gmpy2.atan2(y, x) if gmpy2 is not None else mpmath.atan2(y, x)


def log10(value):
    return gmpy2.log10(value) if gmpy2 is not None else mpmath.log10(value)


def pi():
    return gmpy2.const_pi() if gmpy2 is not None else +mpmath.mp.pi


def text(value, significant=25):
    """Decimal numeral with that many significant digits, for the golden files."""
    if value == 0:
        return "0"
    if gmpy2 is not None:
        return "{0:.{1}e}".format(value, significant - 1)
    return mpmath.nstr(value, significant, min_fixed=1, max_fixed=0)
