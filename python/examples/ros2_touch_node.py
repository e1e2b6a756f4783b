"""A ROS 2 node that tells the shape under a finger after every touch.

    /touch  geometry_msgs/PoseStamped    position: the contact, metres; orientation: its z axis is the outward normal
    /shape  std_msgs/Float64MultiArray   S, u(S), R, u(R), number of touches;  layout.dim[0].label: the class

The work is in `ShapeFollower`, which knows nothing of ROS; `tests/test_ros2_example.py` drives it, and the node itself with
stand-ins for the messages. With ROS 2 sourced: python ros2_touch_node.py --ros-args -p domain:=[-0.05,0.05,-0.05,0.05]
"""

from __future__ import annotations

from collections.abc import Sequence

import palpate

# sd of a height in metres, and of slopes: what a good force-torque fingertip does
SIGMA = (2e-4, 0.05, 0.05)


def normal_of(qx: float, qy: float, qz: float, qw: float) -> tuple[float, float, float]:
    """The z axis of an orientation."""
    return 2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx), 1 - 2 * (qx * qx + qy * qy)


class ShapeFollower:
    """Touches in, shapes out; touches that cannot be used are counted."""

    def __init__(self, domain: Sequence[float], sigma: Sequence[float] = SIGMA) -> None:
        # degree 4 follows half a ball; 25 unknowns, three numbers a touch
        self.stream = palpate.TouchStream(domain, sigma=sigma, degree=4)
        self.refused = 0

    def touch(
        self, position: tuple[float, float, float], orientation: tuple[float, float, float, float]
    ) -> palpate.StreamShape | None:
        """The shape after this touch; None while there are too few, or where this one is of no use."""
        try:
            return self.stream.touch(*position, normal_of(*orientation))
        except ValueError:
            self.refused += 1
            return None


def shape_message(message: object, dimension: object, shape: palpate.StreamShape) -> object:
    """Fills a Float64MultiArray and its one MultiArrayDimension."""
    nan = float("nan")
    s = nan if shape.shape_index is None else shape.shape_index
    message.data = [s, shape.u_shape_index, shape.curvedness, shape.u_curvedness, float(shape.contacts)]
    dimension.label, dimension.size, dimension.stride = shape.class_name or "undefined", 5, 5
    message.layout.dim = [dimension]
    return message


def main() -> None:
    """Spins the node."""
    import rclpy
    from geometry_msgs.msg import PoseStamped
    from rclpy.node import Node
    from std_msgs.msg import Float64MultiArray, MultiArrayDimension

    class TouchNode(Node):
        def __init__(self) -> None:
            super().__init__("palpate")
            self.declare_parameter("domain", [-0.05, 0.05, -0.05, 0.05])
            self.follower = ShapeFollower(self.get_parameter("domain").value)
            self.out = self.create_publisher(Float64MultiArray, "shape", 10)
            self.create_subscription(PoseStamped, "touch", self.touched, 50)

        def touched(self, pose: PoseStamped) -> None:
            p, q = pose.pose.position, pose.pose.orientation
            shape = self.follower.touch((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))
            if shape is not None:
                self.out.publish(shape_message(Float64MultiArray(), MultiArrayDimension(), shape))

    rclpy.init()
    node = TouchNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
