// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capture/sensor_sample.h"
#include "capture/source_condition.h"
#include "proto/disparity.pb.h"

/// The camera's sensors as messages of the protocol.
namespace disparityd::daemon {

void fill_message(const capture::SensorSample& sample, v1::SensorSample& message);
v1::SensorStatus to_message(const capture::SensorFacts& sensors);

}  // namespace disparityd::daemon
