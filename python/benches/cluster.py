"""A study on a Dask cluster of 1, 2 and 4 workers beside one process, and once with a worker killed in the middle; and what
10^11 replicates would take.

    python benches/cluster.py [--replicates N] [--record ../benches/runs/python.md]

Efficiency is the processor time of one process over that of all workers for the same replicates: what sharing out costs,
whatever else the machine does. The clock beside it means something only on a machine with as many idle cores.
"""

from __future__ import annotations

import argparse
import os
import signal
import time
from pathlib import Path

import dask
from distributed import Client, LocalCluster

import palpate
import palpate.dask

SCENE = "paper-table2"
# a study that outgrows one machine
FAR = 10**11
# not the fixed-sites path, which does a million replicates a second: each replicate is fitted for itself
WORDS = {"path": "refit", "attribution": 0}


# Dask's own sampling of its workers, every 10 ms of the clock, would count as work on a busy machine
dask.config.set({"distributed.worker.profile.enabled": False})


def worker_seconds() -> float:
    """Processor time of a worker so far."""
    return sum(os.times()[:2])


def on_cluster(workers: int, replicates: int, kill: bool) -> tuple[palpate.Study, float, float]:
    """The study, the processor time of the workers, and the clock; a killed worker's time is lost to the sum."""
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(workers)
        # the library is loaded before the clock starts
        client.run(palpate.scenes)
        before = sum(client.run(worker_seconds).values())
        victims, done = list(client.run(os.getpid).values()), []

        def progress(now: int, of: int) -> None:
            done.append(now)
            if kill and now * 3 > of and victims:
                os.kill(victims.pop(), signal.SIGKILL)
                victims.clear()

        began = time.monotonic()
        found = palpate.dask.study(SCENE, replicates, client, parts=32, progress=progress, **WORDS)
        clock = time.monotonic() - began
        return found, sum(client.run(worker_seconds).values()) - before, clock


def table(replicates: int) -> str:
    """All of it as Markdown."""
    began, clock = time.process_time(), time.monotonic()
    alone = palpate.study(SCENE, replicates, threads=1, **WORDS)
    one, clock = time.process_time() - began, time.monotonic() - clock
    lines = [
        f"`{SCENE}`, {replicates:,} replicates, each refitted, in 32 parts on {os.cpu_count()} cores.",
        "",
        "| where | same bits | processor seconds | efficiency | clock, seconds |",
        "|---|---|---|---|---|",
        f"| one process, one thread | | {one:.1f} | | {clock:.1f} |",
    ]
    for workers, kill in [(1, False), (2, False), (4, False), (2, True), (4, True)]:
        found, spent, clock = on_cluster(workers, replicates, kill)
        same = "yes" if found == alone else "NO"
        share = "-" if kill else f"{one / spent:.2f}"
        what = f"{workers} worker{'s' if workers > 1 else ''}{', one killed after a third' if kill else ''}"
        lines.append(f"| {what} | {same} | {'-' if kill else f'{spent:.1f}'} | {share} | {clock:.1f} |")
    return "\n".join(lines)


def cost() -> str:
    """What 10^11 replicates cost, from the rate of the last of them on one thread, as Markdown."""
    cylinder = palpate.scene("paper-cylinder")
    noise = "\n[effects.row_noise]\nsigma_z = 0.02\nsigma_slope = 0.05\n"
    ways = [
        ("`paper-cylinder` with `row_noise`: one factor for all replicates", cylinder + noise, 4_000_000),
        ("`paper-table2`: each replicate refitted", SCENE, 200_000),
        ("the same with `weights = \"auto\"`: each a whole fit, noise found", SCENE, 2_000),
    ]
    lines = [
        "| study | replicates a second of one core | 10^11 replicates, core-hours | on 1000 cores |",
        "|---|---|---|---|",
    ]
    for name, scene, count in ways:
        words = {"weights": "auto"} if "auto" in name else {}
        took = []
        # the pilot that places the bins, and loading, belong to a part of any length: the difference leaves them out
        for n in (count // 4, count):
            began = time.process_time()
            palpate.study(scene, FAR, range=(FAR - n, FAR), threads=1, attribution=0, **words)
            took.append(time.process_time() - began)
        rate = (count - count // 4) / (took[1] - took[0])
        hours = FAR / rate / 3600
        lines.append(f"| {name} | {rate:,.0f} | {hours:,.0f} | {_time(hours / 1000)} |")
    return "\n".join(lines)


def _time(hours: float) -> str:
    return f"{3600 * hours:.0f} seconds" if hours < 1 / 30 else f"{60 * hours:.0f} minutes" if hours < 2 else f"{hours:.1f} hours"


def main() -> None:
    """Prints the table; --record puts it between the marks of a file."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--replicates", type=int, default=400_000)
    parser.add_argument("--record", type=Path)
    arguments = parser.parse_args()
    for name, made in (("cost", cost), ("cluster", lambda: table(arguments.replicates))):
        text = made()
        print(text, end="\n\n")
        if arguments.record:
            head, tail = f"<!-- {name} -->", f"<!-- /{name} -->"
            where = arguments.record
            stand = where.read_text(encoding="utf-8") if where.exists() else ""
            stand = stand if head in stand else f"{stand}\n{head}\n{tail}\n"
            before, after = stand.split(head)[0], stand.split(tail)[1]
            where.write_text(f"{before}{head}\n{text}\n{tail}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
