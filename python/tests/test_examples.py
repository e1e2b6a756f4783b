"""The examples run, the cluster scripts without a cluster; those of ROS 2 have a file of their own."""

from __future__ import annotations

import os
import runpy
import subprocess
from pathlib import Path

import pytest
from test_fit import program

import palpate

HOME = Path(__file__).parents[1]


def test_ten_lines_find_the_bar(capsys: pytest.CaptureFixture[str]) -> None:
    found = runpy.run_path(str(HOME / "examples" / "ten_lines.py"))
    assert found["fit"].shape.class_name == "ridge"
    low, high = found["fit"].shape.radius_interval
    assert low < 25 < high and "shape      ridge" in capsys.readouterr().out


def test_the_readme_runs(capsys: pytest.CaptureFixture[str]) -> None:
    text = (HOME / "README.md").read_text(encoding="utf-8")
    block = text.split("```python\n")[1].split("```")[0]
    exec(compile(block, "README.md", "exec"), {})
    assert "ridge" in capsys.readouterr().out


@pytest.mark.skipif(os.name == "nt", reason="bash")
@pytest.mark.parametrize("script", ["slurm_array.sh", "on_one_machine.sh"])
def test_cluster_scripts_give_the_bits_of_one_run(script: str, tmp_path: Path) -> None:
    name = program()
    if name is None:
        pytest.skip("the program palpate is not built")
    places = {"PATH": f"{Path(name).parent}{os.pathsep}{os.environ['PATH']}", "PALPATE_PARTS": str(tmp_path / "parts")}
    environment = {**os.environ, **places}
    words = ["bash", str(HOME / "cluster" / script), "paper-table2", "9000"]
    if script == "slurm_array.sh":
        for task in range(3):
            array = {"SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_COUNT": "3", "SLURM_ARRAY_TASK_MIN": "0"}
            subprocess.run(words, env={**environment, **array}, check=True)
    else:
        subprocess.run([*words, "3"], env=environment, check=True)
    parts = sorted((tmp_path / "parts").glob("part-*"))
    assert len(parts) == 3
    assert palpate.merge(parts) == palpate.study("paper-table2", 9000)
