"""Runs the notebooks: `notebooks/run` makes the environment and calls this.

    python execute.py FOLDER [--record] [NAME...]

The sources are the files `NN-name.py` (jupytext, "percent" cells). Each is executed from the top; what comes out goes to
FOLDER, or with --record beside its source. Nothing that differs between two runs of the same page is kept (times of cells,
numbers of the kernel's version), so that a page changes only when its text, its figures or its numbers do.
Without --record the kept page must hold the cells of its source, so that none is forgotten.
"""

import os
import re
import sys
import time
from pathlib import Path

import jupytext
import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

HERE = Path(__file__).resolve().parent
# a cell that takes longer is stuck; all pages together may take 300
SECONDS = 240
MOST_BYTES = 300_000
# matplotlib writes its own version into a picture unless told not to
QUIET_PICTURES = "%config InlineBackend.print_figure_kwargs = {'metadata': {'Software': None}, 'bbox_inches': None}"


def source(path):
    page = jupytext.read(path)
    for number, cell in enumerate(page.cells):
        cell.id = f"cell-{number:02d}"
        cell.metadata = {}
    page.metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return page


def executed(path):
    page = source(path)
    page.cells.insert(0, nbformat.v4.new_code_cell(QUIET_PICTURES))
    client = NotebookClient(page, timeout=SECONDS, kernel_name="python3", resources={"metadata": {"path": str(HERE)}})
    client.create_kernel_manager()
    if os.name == "posix":
        # talk to the kernel by files that only this user reads, not over ports
        client.km.transport = "ipc"
    client.execute()
    page.cells.pop(0)
    counted = 0
    for cell in page.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            counted += 1
            cell.execution_count = counted
            for output in cell.outputs:
                if "metadata" in output:
                    output.metadata = {}
                if "execution_count" in output:
                    output.execution_count = counted
    page.metadata = {"kernelspec": page.metadata["kernelspec"], "language_info": {"name": "python"}}
    return page


def same_cells(path):
    """Whether the kept page holds the cells of its source."""
    kept = path.with_suffix(".ipynb")
    if not kept.exists():
        return False
    texts = lambda page: [(cell.cell_type, cell.source) for cell in page.cells]
    return texts(nbformat.read(kept, as_version=4)) == texts(source(path))


def run_one(path, target, record):
    """What is wrong with the page, or nothing."""
    try:
        page = executed(path)
    except CellExecutionError as fault:
        return re.sub(r"\x1b\[[0-9;]*m", "", str(fault))
    nbformat.write(page, target / f"{path.stem}.ipynb")
    size = (target / f"{path.stem}.ipynb").stat().st_size
    if size > MOST_BYTES:
        return f"{size} bytes are more than {MOST_BYTES}"
    if not record and not same_cells(path):
        return f"the kept page does not hold the cells of its source: run 'notebooks/run --record {path.stem}'"
    return ""


def main():
    folder, *words = sys.argv[1:]
    record = "--record" in words
    names = [word for word in words if word != "--record"]
    chosen = [p for p in sorted(HERE.glob("[0-9][0-9]-*.py")) if not names or any(p.name.startswith(n) for n in names)]
    if not chosen:
        sys.exit(f"no notebook has a name that begins with {' or '.join(names)}")
    wrong = 0
    for path in chosen:
        start = time.monotonic()
        fault = run_one(path, HERE if record else Path(folder), record)
        print(f"{path.stem:32} {time.monotonic() - start:5.1f} s  {fault or 'holds'}", flush=True)
        wrong += bool(fault)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
