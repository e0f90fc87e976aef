// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bridges/web/metrics/exposition.h"
#include "proto/disparity.pb.h"

namespace disparityd::web {

/// Writes the metrics of a live camera. Its counts are those of the source in use: they start anew with a reload, which
/// Prometheus takes for what it is, a reset.
void put_camera(Exposition& out, const v1::CameraStatus& camera);

/// Writes the metrics of a camera's sensors; counts as put_camera().
void put_sensors(Exposition& out, const v1::SensorStatus& sensors);

/// Writes the correction of the factory calibration that is in use.
void put_self_calibration(Exposition& out, const v1::SelfCalibration& calibration);

}  // namespace disparityd::web
