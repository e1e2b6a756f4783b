"""The examples run, the ROS 2 node with stand-ins for ROS, the cluster scripts without a cluster."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
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


def module(name: str, **names: object) -> types.ModuleType:
    made = types.ModuleType(name)
    made.__dict__.update(names)
    return made


def thing(**names: object) -> types.SimpleNamespace:
    return types.SimpleNamespace(**names)


def test_the_ros2_node_needs_no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    published: list[types.SimpleNamespace] = []
    heard: dict = {}

    class Node:
        def __init__(self, name: str) -> None:
            self.name = name

        def declare_parameter(self, name: str, value: object) -> None:
            self.value = value

        def get_parameter(self, name: str) -> types.SimpleNamespace:
            return thing(value=self.value)

        def create_publisher(self, kind: object, topic: str, depth: int) -> types.SimpleNamespace:
            return thing(publish=published.append)

        def create_subscription(self, kind: object, topic: str, call: object, depth: int) -> None:
            heard[topic] = call

        def destroy_node(self) -> None:
            heard["end"] = True

    def spin(node: Node) -> None:
        # a ball of radius 0.1 m under the finger; the last touch lies beside the domain
        for x, y in [(a * 0.02, b * 0.02) for a in range(-2, 3) for b in range(-2, 3)] + [(1.0, 0.0)]:
            n = np.array([x, y, np.sqrt(0.01 - min(x * x + y * y, 0.009))]) / 0.1
            angle, axis = np.arccos(n[2]), np.array([-n[1], n[0], 0.0])
            axis = axis / (np.linalg.norm(axis) or 1.0) * np.sin(angle / 2)
            q = thing(x=axis[0], y=axis[1], z=0.0, w=np.cos(angle / 2))
            heard["touch"](thing(pose=thing(position=thing(x=x, y=y, z=0.1 * n[2] - 0.1), orientation=q)))
        raise KeyboardInterrupt

    message = lambda: thing(data=None, layout=thing(dim=None))  # noqa: E731
    fakes = {
        "rclpy": module("rclpy", init=lambda: None, spin=spin, try_shutdown=lambda: None),
        "rclpy.node": module("rclpy.node", Node=Node),
        "geometry_msgs": module("geometry_msgs"),
        "geometry_msgs.msg": module("geometry_msgs.msg", PoseStamped=object),
        "std_msgs": module("std_msgs"),
        "std_msgs.msg": module("std_msgs.msg", Float64MultiArray=message, MultiArrayDimension=thing),
    }
    for name, fake in fakes.items():
        monkeypatch.setitem(sys.modules, name, fake)
    runpy.run_path(str(HOME / "examples" / "ros2_touch_node.py"))["main"]()
    assert heard["end"] and len(published) > 5
    last = published[-1]
    s, _, r, u, touches = last.data
    assert last.layout.dim[0].label == "cap" and touches == 25 and abs(r - 10) < 0.5 and s > 0.9 and u > 0


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
