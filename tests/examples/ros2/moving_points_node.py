#!/usr/bin/env python3
"""moving_points_node.py: a ROS 2 node that publishes on `moving` the points of `points` (PointCloud2) that move.

Needs poses on /tf, from the parameter `map_frame` (map) to the frame of the points.
"""

import numpy as np
import rclpy  # type: ignore
import rclpy.duration  # type: ignore
import rclpy.time  # type: ignore
import tf2_ros  # type: ignore
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2  # type: ignore
from sensor_msgs_py import point_cloud2  # type: ignore

import mosbench


def matrix(transform) -> NDArray[np.float64]:  # type: ignore
    """Returns the pose (4, 4) of a geometry_msgs/Transform."""
    x, y, z, w = (getattr(transform.rotation, axis) for axis in "xyzw")
    pose = np.eye(4)
    pose[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]  # fmt: skip
    pose[:3, 3] = [getattr(transform.translation, axis) for axis in "xyz"]
    return pose


def start(config: mosbench.Config):  # type: ignore
    """Returns the node. A scan that no transform covers is left out, and said."""
    node = rclpy.create_node("moving_points")
    map_frame = node.declare_parameter("map_frame", "map").value
    transforms = tf2_ros.Buffer()
    node.listener = tf2_ros.TransformListener(transforms, node)
    publisher = node.create_publisher(PointCloud2, "moving", 10)
    mos = mosbench.MOS(config)

    def take(message) -> None:  # type: ignore
        try:
            stamp = rclpy.time.Time.from_msg(message.header.stamp)
            wait = rclpy.duration.Duration(seconds=0.05)
            found = transforms.lookup_transform(map_frame, message.header.frame_id, stamp, wait)
        except tf2_ros.TransformException as error:
            node.get_logger().warning(f"scan left out: {error}")
            return
        points = point_cloud2.read_points_numpy(message, ["x", "y", "z"]).astype(np.float32)
        for result in mos.push(points, matrix(found.transform)):  # one: online, a scan is final at once
            publisher.publish(point_cloud2.create_cloud_xyz32(message.header, points[result.moving]))

    node.create_subscription(PointCloud2, "points", take, 10)
    return node


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(start(mosbench.Config.preset("semantickitti", method="hmm-mos-plus")))
