"""The scripts of `cluster` under real schedulers, with tasks lost in the middle: is the study that of one process, bit for bit?

    python benches/schedulers.py [--program PALPATE] [--replicates N] [--record ../benches/runs/schedulers.md]

Slurm is started here for the trial: munged, slurmctld and slurmd on this machine, two processors, no cgroups. That needs root
and `apt-get install slurm-wlm munge parallel`, or their like. Three tasks of the array are lost: one is put back by
`scontrol requeue` while it computes, one loses its process to `kill -9` and is made up for by a task of its own, one is
cancelled and likewise. GNU parallel loses one process, is then ended itself, and is started again by the same line.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

HOME = Path(__file__).resolve().parents[1]
SCENE, TASKS = "paper-table2", 20
# what depends on the clock is no part of the numbers
CLOCK = ("seconds", "replicates_per_second")

SLURM = """ClusterName=one
SlurmctldHost={host}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=requeue_delay=1
NodeName={host} CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def until(what: Callable[[], object], seconds: float = 600.0) -> object:
    """The first answer that is not empty."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if answer := what():
            return answer
        time.sleep(0.1)
    raise TimeoutError


class Trial:
    """A folder in which lines are run as a user would, and the transcript of them."""

    def __init__(self, folder: Path, program: Path, more: dict[str, str] | None = None) -> None:
        self.folder = folder
        folder.mkdir()
        for script in (HOME / "cluster").glob("*.sh"):
            shutil.copy(script, folder)
        self.environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}", **(more or {})}
        self.said: list[str] = []

    def run(self, line: str, quiet: bool = False) -> str:
        """What a line of bash prints, faults too."""
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.environment, text=True, stdout=-1, stderr=-2)
        printed = done.stdout.strip()
        if not quiet:
            self.said.append(f"$ {line}" + (f"\n{printed}" if printed else ""))
        return printed

    def note(self, text: str) -> None:
        self.said.append(f"# {text}")

    def process_of(self, task: int) -> int | None:
        """The palpate that computes a part."""
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
                here = os.readlink(entry / "cwd") == str(self.folder)
            except OSError:
                continue
            if here and words[0].endswith(b"palpate") and f"parts/unfinished-{task:05d}".encode() in words:
                return int(entry.name)
        return None

    def parts(self) -> int:
        return len(list((self.folder / "parts").glob("part-*")))

    def verdict(self, alone: dict) -> str:
        """Whether the merged document is that of one process."""
        found = json.loads((self.folder / "study.json").read_text())
        differ = [name for name in {**alone, **found} if name not in CLOCK and alone.get(name) != found.get(name)]
        count = len([name for name in found if name not in CLOCK])
        return f"All {count} keys equal, to the bit." if not differ else f"DIFFERENT: {', '.join(differ)}"


@contextmanager
def cluster(folder: Path) -> Iterator[dict[str, str]]:
    """A Slurm of one machine; its variables."""
    host = socket.gethostname().split(".")[0]
    for name in ("state", "spool"):
        (folder / name).mkdir()
    (folder / "slurm.conf").write_text(SLURM.format(host=host, folder=folder))
    own = {"SLURM_CONF": str(folder / "slurm.conf")}
    if subprocess.run(["munge", "-n"], capture_output=True).returncode:
        Path("/run/munge").mkdir(exist_ok=True)
        shutil.chown("/run/munge", "munge", "munge")
        subprocess.run(["runuser", "-u", "munge", "--", "munged"], check=True)
    daemons = [subprocess.Popen([name, "-D"], env={**os.environ, **own}) for name in ("slurmctld", "slurmd")]
    try:
        ask = ["sinfo", "-h", "-t", "idle", "-o", "%N"]
        until(lambda: subprocess.run(ask, env={**os.environ, **own}, capture_output=True).stdout.strip(), 60)
        yield own
    finally:
        for daemon in reversed(daemons):
            daemon.terminate()
            daemon.wait()


def under_slurm(program: Path, room: Path, words: str, alone: dict) -> list[str]:
    with cluster(room) as own:
        trial = Trial(room / "slurm", program, own)
        trial.run("sbatch --version")
        job = trial.run(f"sbatch --parsable --array=0-{TASKS - 1} slurm_array.sh {words}")
        until(lambda: trial.process_of(3))
        trial.note("task 3 computes")
        trial.run(f"scontrol requeue {job}_3")
        trial.note(f"task 7 computes: kill -9 {{the palpate of part-00007}}")
        os.kill(until(lambda: trial.process_of(7)), signal.SIGKILL)
        until(lambda: trial.process_of(11))
        trial.note("task 11 computes")
        trial.run(f"scancel {job}_11")
        until(lambda: not trial.run("squeue -h", quiet=True))
        trial.run(f"scontrol show job {job} | grep -oE 'ArrayTaskId=[0-9]+|JobState=[A-Z]+|Restarts=[0-9]+' "
                  "| paste - - - | grep -vE 'COMPLETED.Restarts=0'")
        trial.run("ls parts/part-* | wc -l")
        trial.run("palpate merge parts/part-* --json > study.json")
        again = trial.run(f"PALPATE_TASKS={TASKS} sbatch --parsable --array=7,11 slurm_array.sh {words}")
        trial.run(f"sbatch --parsable --dependency=afterany:{again} --wrap 'palpate merge parts/part-* --json > study.json'")
        until(lambda: not trial.run("squeue -h", quiet=True))
        trial.run("ls parts/part-* | wc -l")
    return [*trial.said, f"# {trial.verdict(alone)}"]


def under_parallel(program: Path, room: Path, words: str, alone: dict) -> list[str]:
    trial = Trial(room / "parallel", program)
    trial.run("parallel --version | head -1")
    scene, replicates, *options = words.split()
    line = f"bash on_one_machine.sh {scene} {replicates} {TASKS} {' '.join(options)}".strip()
    trial.said.append(f"$ {line}")
    # a group of its own, as a shell gives it, so that ending it ends what it started
    running = subprocess.Popen(
        line.split(), cwd=trial.folder, env=trial.environment, stdout=-1, stderr=-2, text=True, start_new_session=True
    )
    os.kill(until(lambda: trial.process_of(3)), signal.SIGKILL)
    trial.note("kill -9 {the palpate of part-00003} while it computes")
    until(lambda: trial.process_of(9))
    os.killpg(running.pid, signal.SIGKILL)
    running.communicate()
    trial.note("kill -9 {the script, GNU parallel and all that they started} while part-00009 is computed")
    trial.run("ls parts/part-* | wc -l; ls parts | grep -v part-")
    trial.run("cut -f 1,7,8 parts/joblog | sort -n | awk 'NR > 1 && ($2 || $3)'")
    trial.run(f"{line} | head -2")
    trial.run("ls parts/part-* | wc -l")
    trial.run("tail -n +2 parts/joblog | wc -l")
    trial.run("palpate merge parts/part-* --json > study.json")
    return [*trial.said, f"# {trial.verdict(alone)}"]


def main() -> None:
    """Prints what was run and what it printed; --record keeps it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", type=Path, default=HOME.parent / "target" / "release" / "palpate")
    parser.add_argument("--replicates", type=int, default=5_000_000)
    parser.add_argument("--record", type=Path)
    arguments = parser.parse_args()
    program, words = arguments.program.resolve(), f"{SCENE} {arguments.replicates}"
    line = [program, "study", SCENE, "--replicates", str(arguments.replicates), "--json", "--quiet"]
    alone = json.loads(subprocess.run(line, check=True, capture_output=True).stdout)
    said = ["## One process", "```", f"$ palpate study {SCENE} --replicates {arguments.replicates} --json > alone.json", "```"]
    for title, trial in (("Slurm", under_slurm), ("GNU parallel", under_parallel)):
        with tempfile.TemporaryDirectory(prefix="palpate-") as room:
            lines = trial(program, Path(room).resolve(), words, alone)
        said += ["", f"## {title}", "", "```", *lines, "```"]
    text = "\n".join(said)
    print(text)
    if arguments.record:
        head = "<!-- transcript -->"
        before = arguments.record.read_text(encoding="utf-8").split(head)[0] if arguments.record.exists() else ""
        arguments.record.write_text(f"{before}{head}\n{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
