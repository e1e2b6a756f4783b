"""Is a second number larger than a first one, or is that noise?

    pair i       d_i = ln(after_i / before_i)          both run one after the other, so that what slows the machine slows both
    change       median of d, with the interval that pairs drawn again give in LEVEL of all cases
    alarm        the interval leaves out 0 and the median is at least LEAST_CHANGE; a count is alarmed from LEAST_COUNT on

Pairs drawn again: B. Efron, Ann. Statist. 7 (1979) 1. Runs that something else interrupted are a few large d, which a median does not
follow. `python -m unittest discover benches/track` plants slowdowns and compares nothing with itself.
"""

import math
import random
import statistics
from dataclasses import dataclass

# of 100 comparisons of the same thing about one is then alarmed
LEVEL = 0.99
# changes below this are nobody's concern, and code that is laid out anew in memory moves by as much
LEAST_CHANGE = 0.015
# instructions move by a few thousandths with the environment
LEAST_COUNT = 0.01
SAMPLES = 1000


@dataclass(frozen=True)
class Change:
    """By what factor something became larger, its interval, and whether that is more than noise."""

    ratio: float
    lo: float
    hi: float
    alarm: bool


def of_pairs(pairs, level=LEVEL, least=LEAST_CHANGE):
    """The change between both numbers of pairs (before, after); None of fewer than 6, whose interval would be all of them."""
    logs = [math.log(after / before) for before, after in pairs if before > 0 and after > 0]
    if len(logs) < 6:
        return None
    draw = random.Random(len(logs))
    medians = sorted(statistics.median(draw.choices(logs, k=len(logs))) for _ in range(SAMPLES))
    tail = round(0.5 * (1 - level) * SAMPLES)
    middle, lo, hi = statistics.median(logs), medians[tail], medians[SAMPLES - 1 - tail]
    alarm = (lo > 0 or hi < 0) and abs(middle) >= math.log1p(least)
    return Change(math.exp(middle), math.exp(lo), math.exp(hi), alarm)


def of_counts(before, after, least=LEAST_COUNT):
    """The change of a number that is the same in every run."""
    ratio = after / before if before else (1.0 if after == before else math.inf)
    return Change(ratio, ratio, ratio, abs(ratio - 1.0) >= least)
