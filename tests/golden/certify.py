"""Are these NIST's numbers?  Solves Longley and Filippelli from their DECIMALS and counts the digits in common with NIST's
certified values (15 are published).  Prints one line each; exits 1 below 14.

    python tests/golden/certify.py
"""
import sys

import arithmetic as ar
import least_squares
import nist


def digits(found, certified):
    worst = ar.exact(0)
    for f, c in zip(found, map(ar.decimal, certified)):
        worst = max(worst, abs((f - c) / c))
    return float(-ar.log10(worst))


def main():
    ar.set_digits(80)
    rows, rhs = nist.longley()
    longley = least_squares.solve([[ar.decimal(repr(v)) for v in row] for row in rows], [ar.decimal(repr(v)) for v in rhs])
    x = [ar.decimal(repr(v)) for v in nist.FILIPPELLI_X]
    powers = [[ar.exact(1)] for _ in x]
    for row, u in zip(powers, x):
        for _ in range(10):
            row.append(row[-1] * u)
    filippelli = least_squares.solve(powers, [ar.decimal(repr(v)) for v in nist.FILIPPELLI_Y])
    found = [
        ("Longley", digits(longley.coefficients, nist.LONGLEY_CERTIFIED)),
        ("Filippelli", digits(filippelli.coefficients, nist.FILIPPELLI_CERTIFIED)),
    ]
    for name, count in found:
        print("%-12s %.1f digits of NIST's certified values" % (name, count))
    sys.exit(any(count < 14 for _, count in found))


if __name__ == "__main__":
    main()
