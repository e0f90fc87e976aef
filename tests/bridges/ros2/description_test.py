# SPDX-License-Identifier: Apache-2.0
"""The frames of the robot description are those that disparity-ros2 publishes on /tf_static with the same words.

Usage: description_test.py ALONE PROGRAM. ALONE is disparity_camera_alone.urdf.xacro, PROGRAM ros2_static_transforms. ROS's own xacro and urdfdom's check_urdf are asked,
too, where they are installed.
"""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import small_xacro

ALONE, PROGRAM = sys.argv[1:3]
PART = pathlib.Path(ALONE).resolve().with_name("disparity_camera.urdf.xacro")
PLACE = {"parent": "base_link", "ahead_m": "0.25", "left_m": "-0.06", "height_m": "0.4", "roll_deg": "-3", "pitch_deg": "12.5",
         "yaw_deg": "100"}
IMU = {"imu_xyz": "0.01 -0.02 0.003", "imu_rpy": "0.1 -0.2 1.5"}
# Its own argument has a name that the macro has, too, and comes after the include.
ROBOT = """<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:include filename="{part}"/>
  <xacro:arg name="parent" default="chassis"/>
  <link name="$(arg parent)"/>
  <xacro:disparity_camera name="front" parent="$(arg parent)" ahead_m="0.2"/>
  <xacro:disparity_camera name="rear" parent="$(arg parent)" yaw_deg="180" footprint="false"/>
</robot>
"""
CASES = {
    "a camera alone": {},
    "with a right eye": {"baseline_m": "0.12"},
    "on a robot": {"baseline_m": "0.12", **PLACE},
    "with a frame of scans elsewhere": {**PLACE, "footprint": "false"},
    "with the sensor": {"baseline_m": "0.063", **PLACE, **IMU},
    "with other names": {"names": "zed", "baseline_m": "0.12", **PLACE, **IMU},
}


def rotation_of_rpy(roll, pitch, yaw):
    """Row by row, about fixed axes, as URDF has it."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,
            sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
            -sp, cp * sr, cp * cr]


def rotation_of_quaternion(x, y, z, w):
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]


def numbers(text):
    return [float(word) for word in text.split()]


def frames_of_robot(robot):
    """(parent, child) of each joint, and its rotation and translation."""
    frames = {}
    for joint in robot.iter("joint"):
        assert joint.get("type") == "fixed"
        origin = joint.find("origin")
        frames[joint.find("parent").get("link"), joint.find("child").get("link")] = (
            rotation_of_rpy(*numbers(origin.get("rpy"))) + numbers(origin.get("xyz")))
    links = [link.get("name") for link in robot.iter("link")]
    assert len(links) == len(set(links))
    assert {name for pair in frames for name in pair} <= set(links)
    return frames


def frames_of_bridge(case):
    """The same of what the bridge sends."""
    words = {"parent": "--parent-frame", "footprint": None, "baseline_m": "--told-baseline-m"}
    command = [PROGRAM, "--camera-name", "front"]
    for name, value in case.items():
        if name == "imu_rpy":
            command += ["--told-imu-rotation", *(f"{n:.17g}" for n in rotation_of_rpy(*numbers(value)))]
        elif name == "imu_xyz":
            command += ["--told-imu-mm", *(f"{1000 * n:.17g}" for n in numbers(value))]
        elif name == "footprint":
            command += ["--scan-frame", "elsewhere"]
        else:
            command += [words.get(name, "--" + name.replace("_", "-")), value]
    sent = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {(t["parent"], t["child"]): rotation_of_quaternion(*t["rotation"]) + t["translation"] for t in sent}


class DescriptionTest(unittest.TestCase):
    def check(self, robot, wanted):
        found = frames_of_robot(robot)
        self.assertEqual(found.keys(), wanted.keys())
        for pair, values in wanted.items():
            for a, b in zip(found[pair], values):
                self.assertAlmostEqual(a, b, delta=1e-9, msg=pair)

    def test_frames_are_those_of_the_bridge(self):
        for name, case in CASES.items():
            with self.subTest(name):
                self.check(small_xacro.expand(ALONE, {"name": "front", **case}), frames_of_bridge(case))

    def test_a_robot_has_as_many_cameras_as_it_likes(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "robot.xacro"
            file.write_text(ROBOT.format(part=PART), encoding="utf-8")
            expanded = [small_xacro.expand(file, {})]
            if shutil.which("xacro"):
                text = subprocess.run(["xacro", file], check=True, capture_output=True, text=True).stdout
                expanded.append(ElementTree.fromstring(text.encode()))
            for robot in expanded:
                self.assertEqual(frames_of_robot(robot).keys(),
                                 {("chassis", "front_link"), ("chassis", "front_footprint"), ("front_link", "front_left_optical_frame"),
                                  ("chassis", "rear_link"), ("rear_link", "rear_left_optical_frame")})

    def test_the_part_has_no_arguments(self):
        """They would be the robot's: the first default of a name counts."""
        self.assertEqual(list(ElementTree.parse(PART).getroot().iter(small_xacro.XACRO + "arg")), [])

    def test_a_table_of_names_that_is_not_there_is_refused(self):
        with self.assertRaisesRegex(small_xacro.Fatal, "names: found zde"):
            small_xacro.expand(ALONE, {"name": "front", "names": "zde"})

    def test_ros_own_xacro_expands_the_same(self):
        if not shutil.which("xacro"):
            self.skipTest("no xacro of ROS 2 here")
        for name, case in CASES.items():
            words = [f"{key}:={value}" for key, value in {"name": "front", **case}.items()]
            text = subprocess.run(["xacro", ALONE, *words], check=True, capture_output=True, text=True).stdout
            with self.subTest(name):
                self.check(ElementTree.fromstring(text.encode()), frames_of_bridge(case))

    def test_urdfdom_reads_it(self):
        if not shutil.which("check_urdf"):
            self.skipTest("no check_urdf here (apt-get install liburdfdom-tools)")
        for name, case in CASES.items():
            robot = small_xacro.expand(ALONE, {"name": "front", **case})
            with self.subTest(name), tempfile.NamedTemporaryFile(suffix=".urdf") as file:
                file.write(ElementTree.tostring(robot))
                file.flush()
                told = subprocess.run(["check_urdf", file.name], check=True, capture_output=True, text=True).stdout
                self.assertIn("Successfully Parsed XML", told)
                for pair in frames_of_bridge(case):
                    for link in pair:
                        self.assertIn(link, told)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
