"""What the notebooks share: a call of palpate, the looks of a figure, and the footer.

Nothing is computed here. `palpate(...)` runs the program and returns the JSON document that it prints.
"""

import json
import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
from IPython.display import SVG

HERE = Path(__file__).resolve().parent
# Okabe and Ito's colours, which the colour-blind tell apart; each series has a marker and a line of its own besides
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
LINES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 3))]


def program():
    """The palpate that PALPATE names, else the one that was built here, else the one that is installed."""
    named = os.environ.get("PALPATE")
    built = HERE.parent / "target" / "release" / "palpate"
    found = named or (str(built) if built.exists() else shutil.which("palpate"))
    if not found:
        raise RuntimeError("There is no palpate yet: run 'cargo build --release' in the folder above this one.")
    return found


def call(*arguments, text=None):
    """Runs palpate and returns what it printed. What it complains about becomes the error."""
    words = [str(word) for word in arguments]
    run = subprocess.run([program(), *words], input=text, capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(f"palpate {' '.join(words)}: {run.stderr.strip()}")
    return run.stdout


def palpate(*arguments, text=None):
    """The JSON document of one call, as nested dictionaries."""
    return json.loads(call(*arguments, "--json", text=text))


def drawn(picture, *arguments):
    """The JSON document of one call, and one of the pictures that it draws."""
    with tempfile.TemporaryDirectory() as folder:
        document = palpate(*arguments, "--out", folder)
        return document, SVG(filename=str(Path(folder) / picture))


def tables(*arguments, files, text=None):
    """Runs palpate with `--out` and reads the CSV tables that it writes there."""
    with tempfile.TemporaryDirectory() as folder:
        call(*arguments, "--out", folder, "--quiet", text=text)
        return [pd.read_csv(Path(folder) / name) for name in files]


def figure(columns=1, rows=1, width=8.0, height=3.4, **more):
    """A figure whose parts do not overlap, in black, white and colours that everyone can tell apart."""
    plt.rcParams.update(
        {
            "figure.dpi": 90,
            "font.size": 9,
            "axes.grid": True,
            "grid.color": "#dddddd",
            "axes.axisbelow": True,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "legend.frameon": False,
            "axes.prop_cycle": plt.cycler(color=COLOURS),
        }
    )
    return plt.subplots(rows, columns, figsize=(width, height * rows), layout="constrained", **more)


def footer(seed):
    """Which program, which random numbers and which kind of machine made the page; no names of hosts or folders."""
    processor = platform.machine()
    if os.path.exists("/proc/cpuinfo"):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        processor = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), processor)
    print(f"{call('--version').strip()}; seed {seed}; {platform.system()}, {processor}, {os.cpu_count()} threads")
