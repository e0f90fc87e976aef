# SPDX-License-Identifier: Apache-2.0
"""The configuration files and pages of docs/ros2 name only topics and frames that disparity-ros2 has, in forms that parse.

Usage: configurations_test.py FOLDER PROGRAM, with docs/ros2 and disparity-ros2. Without PyYAML the YAML files are skipped.
"""
import json
import math
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

try:
    import yaml
except ImportError:
    yaml = None

FOLDER, PROGRAM = pathlib.Path(sys.argv[1]), sys.argv[2]
TOPIC = re.compile(r"(?<!\w)/stereo/[\w/]+")  # not those of sed's s/stereo/front/g
FRAME = re.compile(r"\bstereo_(?:\w+_frame|link|imu_link|footprint)\b")
YAML_FILES = sorted(FOLDER.glob("*.yaml")) + sorted(FOLDER.glob("*.rviz"))
STATUS = {
    "geometry": {"width": 672, "height": 376, "f": 260.5, "cx": 335.25, "cy": 187.5, "baseline_mm": 120.0, "disparity_offset": 0,
                 "calibration_id": "12345"},
    "inertial_calibration": {
        "pose": {"rotation": [0, -1, 0, 0, 0, -1, 1, 0, 0], "translation_mm": [10.0, -20.0, 30.0]}, "time_offset": {"seconds": 0.0025},
        "gyroscope_noise_density": 0.0002, "gyroscope_random_walk": 2e-05, "accelerometer_noise_density": 0.002,
        "accelerometer_random_walk": 0.003},
}


def published():
    """Topic -> (type, frame, reliability, durability, kept)."""
    told = subprocess.run([PROGRAM, "--list-topics", "--parent-frame", "base_link"], check=True, capture_output=True, text=True).stdout
    return {line.split()[0]: tuple(line.split()[1:]) for line in told.splitlines()}


def items(tree):
    """All (key, value) pairs at any depth."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield key, value
            yield from items(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from items(value)


@unittest.skipIf(yaml is None, "no PyYAML here (apt-get install python3-yaml)")
class YamlTest(unittest.TestCase):
    def trees(self):
        for file in YAML_FILES:
            with self.subTest(file.name):
                yield file, yaml.safe_load(file.read_text(encoding="utf-8"))

    def test_all_parse(self):
        for _, tree in self.trees():
            self.assertIsInstance(tree, dict)

    def test_displays_of_rviz_match_the_quality_of_service(self):
        found = 0
        for file, tree in self.trees():
            for _, topic in items(tree):
                if file.suffix != ".rviz" or not (isinstance(topic, dict) and "Reliability Policy" in topic):
                    continue
                kept = published()[topic["Value"]]
                found += 1
                self.assertTrue(topic["Reliability Policy"] == "Best Effort" or kept[2] == "reliable", topic)
                self.assertTrue(topic["Durability Policy"] == "Volatile" or kept[3] == "transient-local", topic)
                self.assertEqual(topic["History Policy"], "Keep Last")
        self.assertGreater(found, 2)

    def test_displays_of_rviz_take_the_messages(self):
        tree = yaml.safe_load((FOLDER / "stereo.rviz").read_text(encoding="utf-8"))
        shown = [d for d in tree["Visualization Manager"]["Displays"] if "Topic" in d]
        for display in shown:
            message = published()[display["Topic"]["Value"]][0].rsplit("/", 1)[1]
            self.assertEqual(display["Class"], "rviz_default_plugins/" + message)
        self.assertEqual(tree["Visualization Manager"]["Global Options"]["Fixed Frame"], "stereo_link")

    def test_sources_of_nav2_take_the_messages(self):
        tree = yaml.safe_load((FOLDER / "nav2_costmaps.yaml").read_text(encoding="utf-8"))
        layers = 0
        for _, costmap in items(tree):
            for name in costmap.get("plugins", []) if isinstance(costmap, dict) else []:
                self.assertIn("plugin", costmap[name], name)
                for source in costmap[name].get("observation_sources", "").split():
                    layers += 1
                    wanted = costmap[name][source]
                    self.assertEqual(published()[wanted["topic"]][0], "sensor_msgs/msg/" + wanted["data_type"])
                    if wanted["data_type"] == "LaserScan":
                        self.assertTrue(wanted["inf_is_valid"] and 0 < wanted["expected_update_rate"] <= 1)
                        for limits in (wanted, costmap[name]):  # the scan lies at the height of base_link in odom, which drifts
                            self.assertTrue(limits["min_obstacle_height"] <= -5 and limits["max_obstacle_height"] >= 5)
                if costmap[name]["plugin"].endswith("VoxelLayer"):
                    # Of the 16 voxels of a column one ray leaves 15 unknown, which must not make it free.
                    self.assertGreater(15, costmap[name]["unknown_threshold"] + 16 - costmap[name]["z_voxels"])
        self.assertEqual(layers, 4)

    def test_the_slice_of_nvblox_leaves_the_floor_out(self):
        tree = yaml.safe_load((FOLDER / "nvblox.yaml").read_text(encoding="utf-8"))
        mapper = tree["/**"]["ros__parameters"]["static_mapper"]
        self.assertTrue(0 < mapper["esdf_slice_min_height"] <= mapper["esdf_slice_height"] < mapper["esdf_slice_max_height"])


class NamesTest(unittest.TestCase):
    def test_commands_of_the_pages_are_understood(self):
        commands = 0
        for file in sorted(FOLDER.glob("*.md")):
            for words in re.findall(r"^ {4}disparity-ros2 (.+)$", file.read_text(encoding="utf-8"), re.MULTILINE):
                commands += 1
                with self.subTest(file.name):
                    subprocess.run([PROGRAM, "--list-topics", *shlex.split(words, comments=True)], check=True, capture_output=True)
        self.assertGreater(commands, 2)

    def test_rtabmap_keeps_its_map(self):
        for node in ElementTree.parse(FOLDER / "rtabmap.launch.xml").getroot().iter("node"):
            self.assertFalse({"-d", "--delete_db_on_start"} & set((node.get("args") or "").split()))

    def test_every_topic_is_published(self):
        topics = published()
        for file in sorted(FOLDER.iterdir()):
            text = file.read_text(encoding="utf-8")
            for topic in TOPIC.findall(text):
                with self.subTest(file.name):
                    self.assertIn(topic, topics)
            if file.suffix in (".xml", ".rviz") or file.name.startswith("nav2_"):
                self.assertTrue(TOPIC.search(text), file.name)

    def test_every_frame_is_there(self):
        frames = {line[1] for line in published().values()} | {"stereo_link", "stereo_right_optical_frame"}
        found = set()
        for file in sorted(FOLDER.iterdir()):
            found |= set(FRAME.findall(file.read_text(encoding="utf-8")))
        self.assertEqual(found - frames, set())
        self.assertIn("stereo_right_optical_frame", found)

    def test_remapped_topics_keep_their_meaning(self):
        """An image goes to an image, information to information, left to left."""
        checked = 0
        for file in sorted(FOLDER.glob("*.xml")):
            for remap in ElementTree.parse(file).getroot().iter("remap"):
                source, target = remap.get("from"), remap.get("to")
                if not target.startswith("/stereo/"):
                    continue
                checked += 1
                message = published()[target][0].rsplit("/", 1)[1]
                wanted = "CameraInfo" if "camera_info" in source else "Imu" if "imu" in source else "Image"
                self.assertEqual(message, wanted, remap.attrib)
                right = "right" in source or source.endswith("_1")
                self.assertEqual("/right/" in target, right, remap.attrib)
        self.assertGreater(checked, 10)


class OdometryFilesTest(unittest.TestCase):
    def make(self, status):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        made = subprocess.run([sys.executable, "-B", FOLDER / "odometry_files.py", "-o", folder.name, "--rate", "30", "--imu-rate", "400"],
                              input=json.dumps(status), capture_output=True, text=True, check=False)
        return made, pathlib.Path(folder.name)

    def test_what_is_wrong_is_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            for status, options, code, told in (("", [], 2, "is no status of a daemon"), ("[1]", [], 2, "is no status of a daemon"),
                                                (json.dumps(STATUS), ["--rate", "0"], 2, "--rate: found 0, allowed"),
                                                (json.dumps(STATUS), ["-o", __file__], 1, "File exists"),
                                                (json.dumps(STATUS), ["-o", f"{folder}/new/one"], 0, "")):
                made = subprocess.run([sys.executable, "-B", FOLDER / "odometry_files.py", "-o", folder, "--rate", "30", "--imu-rate", "400",
                                       *options], input=status, capture_output=True, text=True, check=False)
                self.assertEqual(made.returncode, code, made.stderr)
                self.assertIn(told, made.stderr)
                self.assertNotIn("Traceback", made.stderr)
            self.assertTrue((pathlib.Path(folder) / "new/one/kalibr_imucam_chain.yaml").exists())

    def read(self, file):
        text = file.read_text(encoding="utf-8")
        self.assertTrue(text.startswith("%YAML:1.0\n"))
        return yaml.safe_load(text.split("\n", 1)[1].replace("!!opencv-matrix", ""))

    @unittest.skipIf(yaml is None, "no PyYAML here (apt-get install python3-yaml)")
    def test_files_have_the_cameras_and_the_sensor(self):
        made, folder = self.make(STATUS)
        self.assertEqual(made.returncode, 0)
        chain = self.read(folder / "kalibr_imucam_chain.yaml")
        place = [1.0, 2.0, 0.5, 1.0]  # of a point, in the sensor's axes
        seen = []
        for name in ("cam0", "cam1"):
            x, y, z, _ = (sum(a * b for a, b in zip(row, place)) for row in chain[name]["T_cam_imu"])
            fx, fy, cx, cy = chain[name]["intrinsics"]
            seen.append((fx * x / z + cx, fy * y / z + cy, z))
            self.assertIn(chain[name]["rostopic"], published())
            self.assertEqual(chain[name]["timeshift_cam_imu"], 0.0025)
        # By hand: the point is 1 + 0.03 m ahead of the left camera, -2 + 0.01 m to its right, -0.5 - 0.02 m below it.
        self.assertAlmostEqual(seen[0][0], 260.5 * -1.99 / 1.03 + 335.25)
        self.assertAlmostEqual(seen[0][1], 260.5 * -0.52 / 1.03 + 187.5)
        self.assertAlmostEqual(seen[0][0] - seen[1][0], 260.5 * 0.12 / seen[0][2], msg="the disparity")
        self.assertEqual(seen[0][1], seen[1][1])
        imu = self.read(folder / "kalibr_imu_chain.yaml")["imu0"]
        self.assertEqual(imu["gyroscope_random_walk"], 2e-05)
        self.assertIn(imu["rostopic"], published())

    @unittest.skipIf(yaml is None, "no PyYAML here (apt-get install python3-yaml)")
    def test_orb_slam3_gets_the_inverse(self):
        _, folder = self.make(STATUS)
        settings = self.read(folder / "orb_slam3.yaml")
        back = settings["IMU.T_b_c1"]["data"]
        # The left camera's origin in the sensor's axes: -R^T t.
        self.assertEqual([back[3], back[7], back[11]], [-0.03, 0.01, -0.02])
        self.assertEqual(settings["Stereo.b"], 0.12)
        self.assertTrue(math.isclose(settings["IMU.NoiseGyro"], 0.0002))

    def test_an_offset_in_time_that_orb_slam3_cannot_have_is_said(self):
        for offset, told in (({"seconds": 0.0025}, "add 2500 to"), ({"seconds": -0.01}, "add -10000 to"), ({"seconds": 0}, ""), ({}, "")):
            made, _ = self.make({**STATUS, "inertial_calibration": {**STATUS["inertial_calibration"], "time_offset": offset}})
            self.assertEqual(made.returncode, 0)
            self.assertIn(told, made.stderr)
            self.assertEqual(made.stderr == "", told == "")

    def test_an_offset_in_time_that_is_not_known_is_said(self):
        without = {key: value for key, value in STATUS["inertial_calibration"].items() if key != "time_offset"}
        for inertial in (without, {**without, "time_offset": None}):
            made, folder = self.make({**STATUS, "inertial_calibration": inertial})
            self.assertEqual(made.returncode, 0)
            self.assertIn("timeshift_cam_imu is 0 as a guess", made.stderr)
            self.assertIn("timeshift_cam_imu: 0.0\n", (folder / "kalibr_imucam_chain.yaml").read_text(encoding="utf-8"))

    def test_eyes_with_other_middles_are_not_for_orb_slam3(self):
        made, folder = self.make({**STATUS, "geometry": {**STATUS["geometry"], "disparity_offset": 1.5}})
        self.assertEqual(made.returncode, 0)
        self.assertIn("1.5 px apart", made.stderr)
        self.assertFalse((folder / "orb_slam3.yaml").exists())

    def test_what_is_not_known_is_said(self):
        for status, text in (({}, "no calibration of the cameras"), ({**STATUS, "inertial_calibration": None}, "where the inertial sensor is"),
                             ({**STATUS, "inertial_calibration": {**STATUS["inertial_calibration"], "gyroscope_random_walk": 0}},
                              "does not say gyroscope_random_walk")):
            made, folder = self.make(status)
            self.assertEqual(made.returncode, 2)
            self.assertIn(text, made.stderr)
            self.assertEqual(list(folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
