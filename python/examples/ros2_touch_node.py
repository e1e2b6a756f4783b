"""A ROS 2 node that answers every touch: what it is, how sure, and what to touch next.

    touch  geometry_msgs/PoseStamped        position: the contact; orientation: its z axis is the outward normal
    shape  std_msgs/String                  the line of `palpate live --json` after every touch
    marks  visualization_msgs/MarkerArray   surface, green where it is known and red where not; contacts; next touch; words

The work is in `touch_markers.py`, which knows nothing of ROS. Touches wait in a queue of their own and are answered in a thread, so that
none is lost while all are looked at. With ROS 2 sourced:

    python ros2_touch_node.py --ros-args -p state:=touches.json -p window:=500 -p until_radius:=0.001

frame: the frame of the touches; that of the first one without. A sensor that is started anew goes on counting.
"""

from __future__ import annotations

import json
from queue import SimpleQueue
from threading import Thread
from typing import Any

from touch_markers import Marker, TouchFollower, message_of


class TouchDesk:
    """Answers messages in a thread, in the order in which they came."""

    def __init__(self, follower: TouchFollower, publish: Any) -> None:
        self.follower, self.publish = follower, publish
        self.waiting: SimpleQueue[Any] = SimpleQueue()
        self.thread = Thread(target=self._work, name="palpate-desk")
        self.thread.start()

    def _work(self) -> None:
        while (message := self.waiting.get()) is not None:
            try:
                drawn = self.follower.heard(message)
                if drawn:
                    self.publish(self.follower.loop.last, drawn)
            except Exception as error:  # noqa: BLE001
                # the touches that wait are still answered
                self.follower.say(f"message {self.follower.messages}: {error}")

    def close(self) -> None:
        """Answers what waits, and keeps the touches."""
        self.waiting.put(None)
        self.thread.join()
        self.follower.close()


def filled(marker: Any, drawn: Marker, point: Any, colour: Any) -> Any:
    """A visualization_msgs/Marker of a drawing; point and colour make geometry_msgs/Point and std_msgs/ColorRGBA."""
    marker.header.frame_id, marker.ns, marker.id = drawn["frame_id"], drawn["ns"], drawn["id"]
    marker.type, marker.action = drawn["type"], drawn["action"]
    marker.pose.orientation.w = 1.0
    if "scale" in drawn:
        marker.scale.x, marker.scale.y, marker.scale.z = drawn["scale"]
    if "color" in drawn:
        marker.color = _coloured(colour(), drawn["color"])
    if "position" in drawn:
        _placed(marker.pose.position, drawn["position"])
    marker.points = [_placed(point(), place) for place in drawn.get("points", ())]
    marker.colors = [_coloured(colour(), shade) for shade in drawn.get("colors", ())]
    marker.text = drawn.get("text", "")
    return marker


def _placed(point: Any, place: Any) -> Any:
    point.x, point.y, point.z = place
    return point


def _coloured(colour: Any, shade: Any) -> Any:
    colour.r, colour.g, colour.b, colour.a = shade
    return colour


# parameters with the value that stands for none
PARAMETERS = {"frame": "", "state": "", "window": 0, "until_radius": 0.0, "refresh": 0.25}


def main() -> None:
    """Spins the node."""
    import rclpy
    from geometry_msgs.msg import Point, PoseStamped
    from rclpy.node import Node
    from std_msgs.msg import ColorRGBA, String
    from visualization_msgs.msg import Marker as MarkerMessage
    from visualization_msgs.msg import MarkerArray

    class TouchNode(Node):
        def __init__(self) -> None:
            super().__init__("palpate")
            for name, value in PARAMETERS.items():
                self.declare_parameter(name, value)
            given = {name: self.get_parameter(name).value for name in PARAMETERS}
            options = {name: value for name, value in given.items() if value or name == "refresh"}
            self.shapes = self.create_publisher(String, "shape", 10)
            self.marks = self.create_publisher(MarkerArray, "marks", 10)
            self.desk = TouchDesk(TouchFollower(say=self.get_logger().warning, **options), self.publish)
            # every touch counts: the queue is long, and what stands in it is only taken over
            self.create_subscription(PoseStamped, "touch", self.touched, 1000)

        def touched(self, pose: PoseStamped) -> None:
            self.desk.waiting.put(message_of(pose))

        def publish(self, answer: Any, drawn: list[Marker]) -> None:
            line = String()
            line.data = json.dumps(answer.to_dict())
            self.shapes.publish(line)
            array = MarkerArray()
            array.markers = [filled(MarkerMessage(), marker, Point, ColorRGBA) for marker in drawn]
            self.marks.publish(array)

    rclpy.init()
    node = TouchNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.desk.close()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
