"""The node of tests/examples/ros2 on stand-ins of ROS 2's classes: it publishes what mosbench.MOS calls moving."""

import importlib.util
import pathlib
import sys
import types

import numpy as np
import pytest

import mosbench

NODE = pathlib.Path(__file__).resolve().parents[1] / "examples/ros2/moving_points_node.py"


class NoTransform(Exception):
    pass


class Node:
    """Of rclpy, as far as the example goes."""

    def __init__(self):
        self.published, self.warnings = [], []

    def declare_parameter(self, _, value):
        return types.SimpleNamespace(value=value)

    def create_publisher(self, kind, topic, _):
        assert (kind.__name__, topic) == ("PointCloud2", "moving")
        return types.SimpleNamespace(publish=self.published.append)

    def create_subscription(self, kind, topic, take, _):
        assert (kind.__name__, topic) == ("PointCloud2", "points")
        self.take = take

    def get_logger(self):
        return types.SimpleNamespace(warning=self.warnings.append)


def transform_of(pose):
    """Returns a geometry_msgs/TransformStamped of a pose that turns by less than half a turn."""
    w = np.sqrt(1 + np.trace(pose[:3, :3])) / 2
    turn = pose[:3, :3] - pose[:3, :3].T
    rotation = dict(zip("xyz", np.array([turn[2, 1], turn[0, 2], turn[1, 0]]) / (4 * w)), w=w)
    named = types.SimpleNamespace
    return named(transform=named(translation=named(**dict(zip("xyz", pose[:3, 3]))), rotation=named(**rotation)))


@pytest.fixture
def node_module(monkeypatch, street):
    poses = {scan.stem: scan.pose for scan in mosbench.open(street, sequence="08")}

    class Buffer:
        def lookup_transform(self, target, source, stamp, _):
            assert (target, source) == ("map", "lidar")
            if stamp not in poses:
                raise NoTransform("no transform at that time")
            return transform_of(poses[stamp])

    def put(name, **members):
        monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
        sys.modules[name].__dict__.update(members)

    put("rclpy.time", Time=types.SimpleNamespace(from_msg=lambda stamp: stamp))
    put("rclpy.duration", Duration=lambda seconds: seconds)
    put("rclpy", create_node=lambda name: Node(), time=sys.modules["rclpy.time"], duration=sys.modules["rclpy.duration"])
    put("tf2_ros", Buffer=Buffer, TransformListener=lambda buffer, node: None, TransformException=NoTransform)
    put("sensor_msgs")
    put("sensor_msgs.msg", PointCloud2=type("PointCloud2", (), {}))
    put("sensor_msgs_py", point_cloud2=types.SimpleNamespace(
        read_points_numpy=lambda message, names: message.points[:, : len(names)].astype(np.float64),
        create_cloud_xyz32=lambda header, points: (header.stamp, points)))  # fmt: skip
    spec = importlib.util.spec_from_file_location("moving_points_node", NODE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def message_of(scan, stamp):
    return types.SimpleNamespace(header=types.SimpleNamespace(stamp=stamp, frame_id="lidar"), points=scan.points)


def test_publishes_the_moving_points_of_each_scan(node_module, street, near):
    node, mos, found = node_module.start(near), mosbench.MOS(near), 0
    for scan in mosbench.open(street, sequence="08"):
        node.take(message_of(scan, scan.stem))
        stamp, points = node.published[-1]
        assert stamp == scan.stem
        pose = node_module.matrix(transform_of(scan.pose).transform)  # with the rounding of quaternions
        np.testing.assert_allclose(pose, scan.pose, atol=1e-9)
        expected = scan.points[mos.push(scan.points, pose)[0].moving, :3]
        np.testing.assert_array_equal(points, expected)
        found += len(points)
    assert found > 0 and node.warnings == []


def test_leaves_out_a_scan_without_pose_and_says_so(node_module, street, near):
    node = node_module.start(near)
    node.take(message_of(next(iter(mosbench.open(street, sequence="08"))), "later"))
    assert node.published == []
    assert node.warnings == ["scan left out: no transform at that time"]


def test_turns_quaternions_into_matrices(node_module):
    named = types.SimpleNamespace
    turn = named(rotation=named(x=0.5, y=0.5, z=0.5, w=0.5), translation=named(x=1.0, y=2.0, z=3.0))  # x to y to z to x
    np.testing.assert_allclose(node_module.matrix(turn), [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]])
