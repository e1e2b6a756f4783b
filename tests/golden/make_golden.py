"""Writes tests/golden/<case>.json: each hard case's written problem solved by QR in 80 digits, 25 of them kept.

    python -m venv venv && venv/bin/pip install mpmath gmpy2
    venv/bin/python tests/golden/make_golden.py                 write all (or the named) cases
    venv/bin/python tests/golden/make_golden.py --check         solve again in 120 digits and compare with the files
"""
import argparse
import json
import pathlib
import sys
import time

import arithmetic as ar
from cases import all_cases
from inputs import fingerprint
from reference import Reference

FOLDER = pathlib.Path(__file__).parent


def golden(case):
    return {"case": case.name, "inputs": fingerprint(case), **Reference(case).answer()}


def numerals(entry):
    """The 25-digit numerals of one entry of a golden file (a list, or `fitted`'s heights; absent: none)."""
    return (entry["heights"] if isinstance(entry, dict) else entry) or []


def agreement(new, old):
    """Largest difference of two golden files' numerals, relative to the largest numeral of the list; inf if unlike."""
    worst = 0.0
    for key in ("coefficients", "fitted", "S", "R"):
        a, b = (numerals(g.get(key) or []) for g in (new, old))
        if len(a) != len(b) or [v is None for v in a] != [v is None for v in b]:
            return float("inf")
        pairs = [(ar.decimal(u), ar.decimal(v)) for u, v in zip(a, b) if u is not None]
        size = max((abs(v) for _, v in pairs), default=ar.exact(0))
        if size != 0:
            worst = max(worst, float(max(abs(u - v) for u, v in pairs) / size))
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="cases; all without")
    parser.add_argument("--check", action="store_true", help="compare with the files, in 120 digits")
    arguments = parser.parse_args()
    ar.set_digits(120 if arguments.check else 80)
    cases = [c for c in all_cases() if not arguments.names or c.name in arguments.names]
    bad = 0
    for case in cases:
        begun = time.time()
        new, path = golden(case), FOLDER / (case.name + ".json")
        note = ""
        if arguments.check:
            difference = agreement(new, json.loads(path.read_text()))
            note = "agrees to %.0e" % difference
            bad += not difference <= 1e-22
        else:
            path.write_text(json.dumps(new, indent=0) + "\n")
        print("%-30s rank %d of %d, condition %.1e, loss %.1e, %.1f s %s" % (
            case.name, new["rank"], new["unknowns"], new["condition"], new["loss"], time.time() - begun, note), flush=True)  # fmt: skip
    print("%d cases%s" % (len(cases), ", %d disagree" % bad if arguments.check else ""))
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
