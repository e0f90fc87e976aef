# SPDX-License-Identifier: Apache-2.0
"""What a daemon's calibration knows about the inertial sensor."""
from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from . import disparity_pb2 as pb


@dataclasses.dataclass(frozen=True)
class InertialCalibration:
    """What is not known is None. The numbers have the names, signs and units of Kalibr."""

    # Of the frames that rotation and translation hold for (Frame.calibration_id): self-calibration turns the rectified
    # camera.
    calibration_id: int
    # 3x3 and 3 (mm): take points of the sensor's axes, which samples have, to those of the rectified left camera, which
    # Frame.points() has: p_camera = rotation @ p_sensor + translation_mm. They are Kalibr's T_cam_imu, turned as the left
    # image was rectified.
    rotation: npt.NDArray[np.float64] | None
    translation_mm: npt.NDArray[np.float64] | None
    time_offset_s: float | None  # what a frame of the time t shows stands in the samples at t + this
    gyroscope_noise_density: float | None  # white noise, rad/s/sqrt(Hz)
    gyroscope_random_walk: float | None  # of the bias, rad/s2/sqrt(Hz)
    accelerometer_noise_density: float | None  # white noise, m/s2/sqrt(Hz)
    accelerometer_random_walk: float | None  # of the bias, m/s3/sqrt(Hz)


def inertial_calibration(status: pb.Status) -> InertialCalibration | None:
    """Reads it from what status() returns; None where the calibration knows nothing of an inertial sensor."""
    if not status.HasField("inertial_calibration"):
        return None
    found = status.inertial_calibration
    has_pose = len(found.pose.rotation) == 9 and len(found.pose.translation_mm) == 3
    return InertialCalibration(
        calibration_id=status.geometry.calibration_id,
        rotation=np.array(found.pose.rotation).reshape(3, 3) if has_pose else None,
        translation_mm=np.array(found.pose.translation_mm) if has_pose else None,
        time_offset_s=found.time_offset.seconds if found.HasField("time_offset") else None,
        gyroscope_noise_density=found.gyroscope_noise_density or None,
        gyroscope_random_walk=found.gyroscope_random_walk or None,
        accelerometer_noise_density=found.accelerometer_noise_density or None,
        accelerometer_random_walk=found.accelerometer_random_walk or None,
    )
