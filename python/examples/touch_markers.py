"""Messages of a robot's touches in, markers for a viewer out, without ROS: what `ros2_touch_node.py` is made around.

    PoseStamped as a mapping  ->  touch  ->  palpate.LiveLoop  ->  markers as mappings: surface, contacts, next touch, words

A message is what `message_of` makes of a geometry_msgs/PoseStamped, or a line of JSON of a recording in the same words:

    {"header": {"stamp": {"sec": 12, "nanosec": 500000000}, "frame_id": "base"},
     "pose": {"position": {"x": 0.1, "y": 0.0, "z": 0.3}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}

position: the contact, metres. orientation: its z axis is the outward normal; all zeros where the normal is not known.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

import palpate

Message = Mapping[str, Any]
Marker = dict[str, Any]

# of visualization_msgs/Marker
ARROW, SPHERES, WORDS, TRIANGLES = 0, 7, 9, 11
ADD, DELETE = 0, 2

GREEN, RED, GREY, BLUE = (0.1, 0.7, 0.2), (0.9, 0.1, 0.1), (0.5, 0.5, 0.5), (0.1, 0.3, 0.9)

# seconds between two savings on the way
SAVED_EVERY = 1.0


class NoTouch(ValueError):
    """A message that is no touch."""


def message_of(pose: Any) -> Message:
    """A PoseStamped, or what has the same fields, as a mapping."""
    fields = lambda part, names: {name: getattr(part, name) for name in names}  # noqa: E731
    stamp = fields(pose.header.stamp, ("sec", "nanosec"))
    position, orientation = fields(pose.pose.position, "xyz"), fields(pose.pose.orientation, "xyzw")
    header = {"stamp": stamp, "frame_id": pose.header.frame_id}
    return {"header": header, "pose": {"position": position, "orientation": orientation}}


def normal_of(qx: float, qy: float, qz: float, qw: float) -> tuple[float, float, float]:
    """The z axis of an orientation."""
    return 2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy)


def touch_of(message: Message) -> dict[str, Any]:
    """What a live loop hears of a message. Raises NoTouch."""
    try:
        position, orientation = message["pose"]["position"], message["pose"]["orientation"]
        place = [float(position[name]) for name in "xyz"]
        q = np.array([float(orientation[name]) for name in "xyzw"])
        stamp = message["header"]["stamp"]
        seconds = float(stamp["sec"]) + 1e-9 * float(stamp["nanosec"])
    except (KeyError, TypeError, ValueError) as error:
        raise NoTouch(f"no PoseStamped: {type(error).__name__} {error}") from None
    if not all(map(isfinite, (*place, *q, seconds))):
        raise NoTouch("a position, an orientation or a stamp is no finite number")
    size = float(np.sqrt(q @ q))
    normal = list(normal_of(*(q / size))) if size > 0 else [0.0, 0.0, 0.0]
    return {"position": place, "normal": normal, "time": seconds}


class TouchFollower:
    """Messages in, markers out; what is no touch is said in one line and left out.

    frame: the frame of all touches; that of the first touch without. state: a file that keeps the touches, about once a second and
    by `close`, and from which they are taken up again. options: those of palpate.LiveLoop.
    """

    def __init__(
        self,
        *,
        frame: str | None = None,
        state: str | Path | None = None,
        say: Callable[[str], object] = print,
        **options: Any,
    ) -> None:
        self.state = None if state is None else Path(state)
        kept = self.state if self.state is not None and self.state.exists() else None
        self.loop = palpate.LiveLoop(resume=kept, say=say, **options)
        self.frame, self.say, self.messages, self.left_out = frame, say, 0, 0
        self._saved = time.monotonic()

    def heard(self, message: Message | str) -> list[Marker]:
        """The markers after one message, or one line of a recording; none where it is no touch."""
        self.messages += 1
        try:
            message = json.loads(message) if isinstance(message, str) else message
            touch = touch_of(message)
            self._check_frame(str(message["header"].get("frame_id", "")))
        except ValueError as error:
            return self._leave_out(str(error))
        answer = self.loop.hear(touch)
        if answer is None:
            self.left_out += 1
            return []
        if time.monotonic() - self._saved > SAVED_EVERY:
            self.close()
        return markers(self.loop, answer, self.frame or "")

    def _check_frame(self, frame: str) -> None:
        self.frame = self.frame or frame
        if frame != self.frame:
            raise NoTouch(f"its frame is {frame!r}, and the touches are in {self.frame!r}")

    def _leave_out(self, why: str) -> list[Marker]:
        self.left_out += 1
        self.say(f"message {self.messages}: {why}; no touch, left out")
        return []

    def close(self) -> None:
        """Keeps the touches."""
        self._saved = time.monotonic()
        if self.state is not None:
            self.loop.save(self.state)


def markers(loop: palpate.LiveLoop, answer: palpate.LiveAnswer, frame: str) -> list[Marker]:
    """Everything that is drawn after an answer; a surface is drawn again when all touches were looked at."""
    contacts = loop.contacts
    places = np.column_stack([contacts["x"], contacts["y"], contacts["z"]])
    size = float(np.ptp(places, axis=0).max()) or 0.01
    found = [_contacts(places, size), _next(answer, size), _words(answer, places, size)]
    if answer.answer in ("fresh", "none"):
        found.append(_surface(loop, answer))
    return [{"frame_id": frame, "id": 0, **marker} for marker in found]


def _contacts(places: np.ndarray, size: float) -> Marker:
    thick = 0.02 * size
    return {
        "ns": "contacts", "type": SPHERES, "action": ADD, "scale": (thick, thick, thick), "color": (*BLUE, 1.0),
        "points": places.tolist(),
    }  # fmt: skip


def _surface(loop: palpate.LiveLoop, answer: palpate.LiveAnswer) -> Marker:
    """Triangles, green where the surface is known and red where it is doubtful."""
    if answer.answer == "none":
        return {"ns": "surface", "type": TRIANGLES, "action": DELETE}
    mesh = palpate.surface_mesh(loop.maps(20))
    share = mesh.doubt[:, None]
    shades = np.where(np.isfinite(share), (1 - share) * np.array(GREEN) + share * np.array(RED), GREY)
    corners = mesh.triangles.ravel()
    colours = np.column_stack([shades[corners], np.full(len(corners), 0.8)])
    return {
        "ns": "surface", "type": TRIANGLES, "action": ADD, "scale": (1.0, 1.0, 1.0), "color": (*GREY, 0.8),
        "points": mesh.points[corners].tolist(), "colors": colours.tolist(),
    }  # fmt: skip


def _next(answer: palpate.LiveAnswer, size: float) -> Marker:
    """An arrow from the free side to where the surface is expected."""
    proposed = answer.next
    if proposed is None or proposed.z is None:
        return {"ns": "next", "type": ARROW, "action": DELETE}
    tip, normal = np.array([*proposed.at, proposed.z]), np.array(proposed.normal or (0.0, 0.0, 1.0))
    return {
        "ns": "next", "type": ARROW, "action": ADD, "scale": (0.02 * size, 0.05 * size, 0.08 * size),
        "color": (*RED, 1.0), "points": [(tip + 0.4 * size * normal).tolist(), tip.tolist()],
    }  # fmt: skip


def _words(answer: palpate.LiveAnswer, places: np.ndarray, size: float) -> Marker:
    above = places.mean(axis=0) + [0.0, 0.0, 0.7 * size]
    return {
        "ns": "words", "type": WORDS, "action": ADD, "scale": (0.0, 0.0, 0.08 * size), "color": (*GREY, 1.0),
        "position": above.tolist(), "text": str(answer),
    }  # fmt: skip
