"""Recorded messages become markers without ROS; the node itself runs with stand-ins for it."""

from __future__ import annotations

import importlib
import json
import runpy
import sys
import types
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
RECORDED = Path(__file__).parent / "touches_recorded.jsonl"


@pytest.fixture
def touch_markers(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(EXAMPLES))
    return importlib.import_module("touch_markers")


def recorded() -> list[str]:
    return RECORDED.read_text(encoding="utf-8").splitlines()


def by_name(markers: list[dict]) -> dict[str, dict]:
    return {marker["ns"]: marker for marker in markers}


def test_recorded_messages_become_markers(touch_markers: Any) -> None:
    follower = touch_markers.TouchFollower(say=pytest.fail, refresh=0.5)
    drawn = [by_name(follower.heard(line)) for line in recorded()]
    assert len(drawn) == 30 and follower.frame == "base" and len(follower.loop) == 30
    assert all({"contacts", "next", "words"} <= set(markers) for markers in drawn)
    assert all(marker["frame_id"] == "base" for markers in drawn for marker in markers.values())
    last = follower.loop.finish()
    markers = by_name(touch_markers.markers(follower.loop, last, "base"))
    surface, arrow = markers["surface"], markers["next"]
    assert surface["type"] == 11 and len(surface["points"]) % 3 == 0 and len(surface["points"]) > 600
    assert len(surface["colors"]) == len(surface["points"]) and np.isfinite(surface["colors"]).all()
    # a ball of 0.1 m around the origin of its frame, seen from outside
    distances = np.linalg.norm(np.array(surface["points"]) - [0, 0, -0.1], axis=1)
    assert np.abs(distances - 0.1).max() < 0.01
    tail, tip = np.array(arrow["points"])
    assert np.linalg.norm(tail - [0, 0, -0.1]) > np.linalg.norm(tip - [0, 0, -0.1])
    assert "cap" in markers["words"]["text"] and len(markers["contacts"]["points"]) == 30
    assert drawn[0]["surface"]["action"] == 2 and any("surface" not in markers for markers in drawn)


def test_faults_are_one_clear_line_each_and_nothing_is_lost(touch_markers: Any) -> None:
    said: list[str] = []
    follower = touch_markers.TouchFollower(say=said.append, refresh=1.0)
    good = recorded()
    other_frame = json.loads(good[0])
    other_frame["header"]["frame_id"] = "tool"
    lost = json.loads(good[1])
    lost["pose"]["position"]["z"] = None
    far = good[2].replace('"sec"', '"nothing"')
    faults = [json.dumps(other_frame), json.dumps(lost), far, "{", "[]", json.dumps({"pose": {}})]
    lines = [good[0], *(line for pair in zip(good[1:], faults) for line in pair), *good[len(faults) + 1 :]]
    for line in lines:
        follower.heard(line)
    assert len(follower.loop) == len(good) and follower.left_out == len(said) == len(faults)
    assert all("no touch, left out" in words and "\n" not in words for words in said)
    assert "frame is 'tool', and the touches are in 'base'" in said[0]
    clean = touch_markers.TouchFollower(refresh=1.0)
    for line in good:
        clean.heard(line)
    assert clean.loop.finish().shape == follower.loop.finish().shape


def test_a_sensor_that_starts_anew_and_late_touches_count(touch_markers: Any) -> None:
    said: list[str] = []
    follower = touch_markers.TouchFollower(say=said.append, refresh=1.0)
    good = recorded()
    order = [*good[:10], good[11], good[10], *good[12:20], *good[:10]]
    for line in order:
        follower.heard(line)
    assert len(follower.loop) == 30 and len(said) == 2 and all("it counts all the same" in words for words in said)


def test_the_touches_are_kept(touch_markers: Any, tmp_path: Path) -> None:
    state, good = tmp_path / "touches.json", recorded()
    first = touch_markers.TouchFollower(state=state, refresh=1.0)
    for line in good[:15]:
        first.heard(line)
    first.close()
    second = touch_markers.TouchFollower(state=state, refresh=1.0)
    for line in good[15:]:
        second.heard(line)
    whole = touch_markers.TouchFollower(refresh=1.0)
    for line in good:
        whole.heard(line)
    assert len(second.loop) == 30 and second.loop.finish().shape == whole.loop.finish().shape
    unknown = json.loads(good[0])
    unknown["pose"]["orientation"] = dict.fromkeys("xyzw", 0.0)
    assert second.heard(json.dumps(unknown)) and not second.loop.contacts["nx"][-1]


def module(name: str, **names: object) -> types.ModuleType:
    made = types.ModuleType(name)
    made.__dict__.update(names)
    return made


def thing(**names: object) -> types.SimpleNamespace:
    return types.SimpleNamespace(**names)


def as_pose(line: str) -> types.SimpleNamespace:
    return json.loads(line, object_hook=lambda fields: thing(**fields))


class Node:
    """Stands for a node of ROS."""

    heard: dict[str, Any] = {}
    published: dict[str, list[Any]] = defaultdict(list)
    values: dict[str, object] = {}

    def __init__(self, name: str) -> None:
        self.name = name

    def declare_parameter(self, name: str, value: object) -> None:
        self.values.setdefault(name, value)

    def get_parameter(self, name: str) -> types.SimpleNamespace:
        return thing(value=self.values[name])

    def get_logger(self) -> types.SimpleNamespace:
        return thing(warning=self.published["said"].append)

    def create_publisher(self, kind: object, topic: str, depth: int) -> types.SimpleNamespace:
        return thing(publish=self.published[topic].append)

    def create_subscription(self, kind: object, topic: str, call: object, depth: int) -> None:
        self.heard[topic] = call

    def destroy_node(self) -> None:
        self.heard["end"] = True


def test_the_node_needs_no_ros(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, touch_markers: Any) -> None:
    state = tmp_path / "touches.json"
    monkeypatch.setattr(Node, "values", {"state": str(state), "refresh": 0.5})

    def spin(node: Node) -> None:
        lines = recorded()
        for line in [*lines[:5], lines[5].replace('"base"', '"tool"'), *lines[5:]]:
            node.heard["touch"](as_pose(line))
        raise KeyboardInterrupt

    place = lambda: thing(x=0.0, y=0.0, z=0.0, w=0.0)  # noqa: E731
    marker = lambda: thing(header=thing(), pose=thing(position=place(), orientation=place()), scale=place())  # noqa: E731
    fakes = {
        "rclpy": module("rclpy", init=lambda: None, spin=spin, try_shutdown=lambda: None),
        "rclpy.node": module("rclpy.node", Node=Node),
        "geometry_msgs": module("geometry_msgs"),
        "geometry_msgs.msg": module("geometry_msgs.msg", PoseStamped=object, Point=place),
        "std_msgs": module("std_msgs"),
        "std_msgs.msg": module("std_msgs.msg", ColorRGBA=thing, String=thing),
        "visualization_msgs": module("visualization_msgs"),
        "visualization_msgs.msg": module("visualization_msgs.msg", Marker=marker, MarkerArray=thing),
    }
    for name, fake in fakes.items():
        monkeypatch.setitem(sys.modules, name, fake)
    runpy.run_path(str(EXAMPLES / "ros2_touch_node.py"))["main"]()
    shapes, marks = Node.published["shape"], Node.published["marks"]
    assert Node.heard["end"] and len(shapes) == len(marks) == 30 and len(Node.published["said"]) == 1
    assert json.loads(shapes[-1].data)["touch"] == 30 and state.exists()
    drawn = {marker.ns: marker for array in marks for marker in array.markers}
    assert drawn["surface"].points[0].x is not None and drawn["words"].text and drawn["next"].pose.orientation.w == 1
