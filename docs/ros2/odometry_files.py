#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the calibration of the rectified pair and the inertial sensor for OpenVINS and ORB-SLAM3.

    disparityctl status --json | python3 odometry_files.py -o FOLDER --rate 30 --imu-rate 400

FOLDER gets kalibr_imucam_chain.yaml and kalibr_imu_chain.yaml (OpenVINS) and orb_slam3.yaml. What they say holds as long as the
daemon's calibration_id does, which is in their first lines. Exit status: 0 written, 1 the files cannot be written, 2 something is not
known, or an argument is wrong.
"""
import argparse
import json
import math
import pathlib
import sys

NOISE = ("gyroscope_noise_density", "gyroscope_random_walk", "accelerometer_noise_density", "accelerometer_random_walk")


class Unknown(Exception):
    """What the status does not tell, and what to do."""


def pose_of(status):
    """The rotation as three rows and the translation in m, of the sensor's axes to the left rectified camera."""
    inertial = status.get("inertial_calibration") or {}
    pose = inertial.get("pose")
    if not pose:
        raise Unknown("the calibration does not say where the inertial sensor is: docs/calibration.md, section Inertial sensor")
    if not all(inertial.get(name) for name in NOISE):
        raise Unknown(f"the calibration does not say {', '.join(name for name in NOISE if not inertial.get(name))}: docs/calibration.md")
    rotation = pose["rotation"]
    return [rotation[0:3], rotation[3:6], rotation[6:9]], [mm / 1000 for mm in pose["translation_mm"]], inertial


def note(text):
    print(f"odometry_files.py: note: {text}", file=sys.stderr)


def shift_of(inertial):
    """In s: what a frame of the time t shows stands in the samples at t + shift. Says so where it is not known: then it is 0."""
    offset = inertial.get("time_offset")
    if offset is None:
        note("the calibration does not say how frames and samples lie in time: timeshift_cam_imu is 0 as a guess, and orb_slam3.yaml "
             "takes it for 0; Kalibr measures it: docs/calibration.md, section Inertial sensor")
        return 0.0
    return offset.get("seconds", 0.0)


def real(number):
    """With a point in it, as every reader of YAML takes it for a number."""
    text = repr(float(number))
    return text if "." in text else text.replace("e", ".0e")


def rows_of(rotation, translation):
    return [[*row, t] for row, t in zip(rotation, translation)] + [[0.0, 0.0, 0.0, 1.0]]


def matrix(rows, indent):
    return "".join(f"\n{indent}- [{', '.join(map(real, row))}]" for row in rows)


def camera(geometry, rotation, translation, shift, right):
    """One camera of a Kalibr camchain: rectified, so without distortion."""
    cx = geometry["cx"] + (geometry["disparity_offset"] if right else 0)
    moved = [translation[0] - (geometry["baseline_mm"] / 1000 if right else 0), *translation[1:]]
    eye, number = ("right", 1) if right else ("left", 0)
    return f"""cam{number}:
  T_cam_imu:{matrix(rows_of(rotation, moved), "    ")}
  cam_overlaps: [{1 - number}]
  camera_model: pinhole
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  distortion_model: radtan
  intrinsics: [{real(geometry["f"])}, {real(geometry["f"])}, {real(cx)}, {real(geometry["cy"])}]
  resolution: [{geometry["width"]}, {geometry["height"]}]
  rostopic: TOPICS/{eye}/image_rect
  timeshift_cam_imu: {real(shift)}
"""


def imu_chain(inertial, rate):
    identity = matrix([[1, 0, 0], [0, 1, 0], [0, 0, 1]], "    ")
    nothing = matrix([[0, 0, 0]] * 3, "    ")
    noise = "".join(f"  {name}: {real(inertial[name])}\n" for name in NOISE)
    return f"""imu0:
  T_i_b:{matrix(rows_of([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0]), "    ")}
{noise}  rostopic: TOPICS/imu/data_raw
  time_offset: 0.0
  update_rate: {real(rate)}
  model: "kalibr"
  Tw:{identity}
  R_IMUtoGYRO:{identity}
  Ta:{identity}
  R_IMUtoACC:{identity}
  Tg:{nothing}
"""


def orb_slam3(geometry, rotation, translation, inertial, options):
    if abs(geometry["disparity_offset"]) > 1e-6:
        raise Unknown(f"ORB-SLAM3 takes rectified pairs whose eyes have the same cx; here they are {geometry['disparity_offset']} px apart")
    back = [[rotation[j][i] for j in range(3)] for i in range(3)]
    place = [-sum(r * t for r, t in zip(row, translation)) for row in back]
    data = ", ".join(real(x) for row in rows_of(back, place) for x in row)
    return f"""File.version: "1.0"
Camera.type: "Rectified"
Camera1.fx: {real(geometry["f"])}
Camera1.fy: {real(geometry["f"])}
Camera1.cx: {real(geometry["cx"])}
Camera1.cy: {real(geometry["cy"])}
Stereo.b: {real(geometry["baseline_mm"] / 1000)}
Stereo.ThDepth: 40.0
Camera.width: {geometry["width"]}
Camera.height: {geometry["height"]}
Camera.fps: {round(options.rate)}
Camera.RGB: 1
IMU.T_b_c1: !!opencv-matrix
   rows: 4
   cols: 4
   dt: f
   data: [{data}]
IMU.NoiseGyro: {real(inertial["gyroscope_noise_density"])}
IMU.NoiseAcc: {real(inertial["accelerometer_noise_density"])}
IMU.GyroWalk: {real(inertial["gyroscope_random_walk"])}
IMU.AccWalk: {real(inertial["accelerometer_random_walk"])}
IMU.Frequency: {real(options.imu_rate)}
ORBextractor.nFeatures: 1200
ORBextractor.scaleFactor: 1.2
ORBextractor.nLevels: 8
ORBextractor.iniThFAST: 20
ORBextractor.minThFAST: 7
Viewer.KeyFrameSize: 0.05
Viewer.KeyFrameLineWidth: 1.0
Viewer.GraphLineWidth: 1.0
Viewer.PointSize: 2.0
Viewer.CameraSize: 0.08
Viewer.CameraLineWidth: 3.0
Viewer.ViewpointX: 0.0
Viewer.ViewpointY: -0.7
Viewer.ViewpointZ: -3.5
Viewer.ViewpointF: 500.0
"""


def files_of(status, options):
    """The text of each file, by its name."""
    geometry = status.get("geometry") or {}
    if not (geometry.get("f") and geometry.get("baseline_mm")):
        raise Unknown("the daemon has no calibration of the cameras: docs/calibration.md")
    rotation, translation, inertial = pose_of(status)
    shift = shift_of(inertial)
    head = f"%YAML:1.0\n# The rectified pair of the daemon, calibration_id {geometry['calibration_id']}.\n"
    cameras = "".join(camera(geometry, rotation, translation, shift, right) for right in (False, True))
    files = {"kalibr_imucam_chain.yaml": cameras, "kalibr_imu_chain.yaml": imu_chain(inertial, options.imu_rate)}
    try:
        files["orb_slam3.yaml"] = orb_slam3(geometry, rotation, translation, inertial, options)
        if round(shift * 1e6):
            note(f"orb_slam3.yaml cannot tell the time offset of {shift:.6f} s: add {round(shift * 1e6)} to [source] time_offset_us "
                 "of the daemon, which moves the stamps of frames, then write the files anew")
    except Unknown as reason:
        note(f"no orb_slam3.yaml: {reason}")
    return {name: head + text.replace("TOPICS", options.namespace) for name, text in files.items()}


def frequency(text):
    number = float(text)
    if not (math.isfinite(number) and number >= 1):
        raise argparse.ArgumentTypeError(f"found {text}, allowed: a number of 1 or more, in a second")
    return number


def status_of(text):
    try:
        status = json.loads(text)
    except ValueError:
        status = None
    if not isinstance(status, dict):
        raise Unknown("standard input is no status of a daemon: disparityctl status --json prints one, and says why where it does not")
    return status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, help="the folder; made where it is missing")
    parser.add_argument("--rate", required=True, type=frequency, help="frames per second")
    parser.add_argument("--imu-rate", required=True, type=frequency, help="samples of the inertial sensor per second")
    parser.add_argument("--namespace", default="/stereo", help="of the bridge's topics (default: /stereo)")
    options = parser.parse_args()
    try:
        files = files_of(status_of(sys.stdin.read()), options)
    except Unknown as reason:
        print(f"odometry_files.py: error: {reason}", file=sys.stderr)
        return 2
    try:
        options.output.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (options.output / name).write_text(text, encoding="utf-8")
    except OSError as reason:
        print(f"odometry_files.py: error: {reason.filename}: {reason.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
