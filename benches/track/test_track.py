"""Planted changes are found, and nothing is not: `python -m unittest discover benches/track`."""

import math
import random
import unittest

from changes import LEAST_COUNT, of_counts, of_pairs
from measure import read_counts
from page import page, series
from track import halved, known_line, machine

PAIRS = 30


def timings(draw, slower, pairs=PAIRS):
    """Pairs of times as a busy machine has them: it drifts, every run errs by 2 %, and one in eight is interrupted."""
    drift, found = 0.0, []
    for _ in range(pairs):
        drift += draw.gauss(0.0, 0.01)

        def one(factor):
            interrupted = draw.expovariate(5.0) if draw.random() < 0.125 else 0.0
            return factor * math.exp(drift + draw.gauss(0.0, 0.02)) * (1.0 + interrupted)

        found.append((one(1.0), one(1.0 + slower)))
    return found


class Changes(unittest.TestCase):
    def alarms(self, slower, seed):
        draw = random.Random(seed)
        return [change for change in (of_pairs(timings(draw, slower)) for _ in range(100)) if change.alarm]

    def test_a_hundred_comparisons_with_itself_raise_at_most_five_alarms(self):
        for seed in range(5):
            self.assertLessEqual(len(self.alarms(0.0, seed)), 5, f"seed {seed}")

    def test_a_slowdown_of_five_per_cent_is_found(self):
        found = self.alarms(0.05, 11)
        self.assertGreaterEqual(len(found), 95)
        self.assertTrue(all(change.ratio > 1.0 for change in found))
        # as much faster is found as well
        self.assertGreaterEqual(len(self.alarms(-0.05, 12)), 95)

    def test_two_per_cent_more_instructions_are_found_and_the_environment_is_not(self):
        self.assertTrue(of_counts(1_000_000, 1_020_000).alarm and of_counts(1_000_000, 980_000).alarm)
        self.assertFalse(of_counts(1_000_000, 1_003_000).alarm)
        self.assertLess(LEAST_COUNT, 0.02)

    def test_few_pairs_say_nothing(self):
        self.assertIsNone(of_pairs([(1.0, 2.0)] * 5))
        self.assertTrue(of_pairs([(1.0, 2.0)] * 6).alarm)


def commits():
    """Fifty commits: the thirtieth has 2 % more instructions, the fortieth takes 5 % more time."""
    draw = random.Random(1)
    lines, count = [], 1_000_000
    for k in range(50):
        count = round(count * (1.02 if k == 29 else 1.0 + draw.gauss(0.0, 0.0005)))
        change = of_pairs(timings(draw, 0.05 if k == 39 else 0.0))
        lines.append({
            "commit": f"{k:040x}", "parent": "", "date": "2026-11-26", "subject": f"commit <{k + 1}>", "machine": "one",
            "counts": {"fit": count}, "seconds": {"study": change.__dict__}, "program_bytes": 20_000_000, "accuracy": {"bar, S": 0.01},
        })
    return lines


class Halving(unittest.TestCase):
    def test_a_stretch_that_differs_is_halved_until_the_change_lies_between_neighbours(self):
        names = [f"{k:02}" for k in range(50)]
        compiled = []

        def measured(commit):
            compiled.append(commit)
            return {"commit": commit, "counts": {"fit": 1_000_000 if int(commit) < 29 else 1_020_000}, "accuracy": {"bar, S": 0.01}}

        def compared(before, after):
            slower = int(before) < 41 <= int(after)
            return {"study": {"ratio": 1.05 if slower else 1.0, "lo": 1.0, "hi": 1.06, "alarm": slower}}

        lines = halved(names, measured, compared)
        found = [line["commit"] for line in lines]
        self.assertEqual(found, sorted(found))
        self.assertTrue({"00", "28", "29", "40", "41", "49"} <= set(found))
        self.assertEqual(sorted(compiled), found)
        self.assertLess(len(found), 16)
        marked = {key: [found[point[0]] for point in points if point[4]] for key, points in series(lines).items()}
        self.assertEqual((marked["counts", "fit"], marked["seconds", "study"]), (["29"], ["41"]))

    def test_one_commit_and_commits_that_are_alike_are_measured_at_their_ends(self):
        measured = lambda commit: {"commit": commit, "counts": {"fit": 1}}
        compared = lambda before, after: {"study": {"ratio": 1.0, "lo": 1.0, "hi": 1.0, "alarm": False}}
        self.assertEqual(len(halved(["a"], measured, compared)), 1)
        self.assertEqual([line["commit"] for line in halved(list("abcdefg"), measured, compared)], ["a", "g"])

    def test_commits_of_the_same_sources_share_a_line_and_others_do_not(self):
        line = lambda commit: {"commit": commit, "machine": machine(), "program_bytes": 1}
        sources = {"a": "1", "b": "1", "c": "2", "d": "2"}.get
        has_program = lambda commit: commit != "d"
        found = lambda commit, *lines: known_line(commit, [line(other) for other in lines], sources, has_program)
        self.assertEqual(found("b", "c", "a"), line("a"))
        self.assertEqual(found("b", "a", "b"), line("b"))
        self.assertIsNone(found("c", "a", "b"))
        self.assertIsNone(found("c", "d"))


class Pages(unittest.TestCase):
    def test_the_curves_mark_what_was_planted(self):
        found = series(commits())
        marked = {key: [point[0] for point in points if point[4]] for key, points in found.items()}
        self.assertEqual(marked["counts", "fit"], [29])
        self.assertIn(39, marked["seconds", "study"])
        self.assertLessEqual(len(marked["seconds", "study"]), 3)
        self.assertEqual(marked["build", "program_bytes"], [])

    def test_a_line_of_counts_alone_is_drawn(self):
        said = "fit instructions (avx2)      1020000\nmap instructions   not counted: no valgrind\n1 counts, 1 of them in the baseline, 0 grew\n"
        counts = read_counts(said)
        self.assertEqual(counts, {"fit instructions (avx2)": 1_020_000})
        line = {"commit": "0" * 40, "parent": "", "date": "2026-11-26", "subject": "more", "machine": "one"}
        before = {**line, "counts": {"fit instructions (avx2)": 1_000_000}}
        found = series([before, {**line, "counts": counts}])
        self.assertEqual([point[4] for point in found["counts", "fit instructions (avx2)"]], [None, 1.02])
        self.assertIn("+2.0 %", page([before, {**line, "counts": counts}]))

    def test_the_page_stands_by_itself(self):
        text = page(commits())
        self.assertIn("commit &lt;30&gt;", text)
        self.assertNotIn("<30>", text)
        for word in ("http://", "https://", "<script", "src="):
            self.assertNotIn(word, text)


if __name__ == "__main__":
    unittest.main()
