// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/sensor_sample.h"

/// The samples that travel with a frame, as docs/recordings.md defines them: behind the frame's facts, and only where
/// there are some, so that recordings without are what they always were.
namespace disparityd::capture::recording {

/// Bytes that put_sensors() fills: 0 for none.
std::size_t sensors_size(std::span<const SensorSample> samples);
void put_sensors(std::span<const SensorSample> samples, std::span<std::uint8_t> bytes);

/// What stands behind a frame's facts; of samples that a later version has made longer, what is known here. Nothing
/// when the bytes are damaged. Any bytes may come; takes no more memory than a small multiple of them.
std::optional<std::vector<SensorSample>> get_sensors(std::span<const std::uint8_t> bytes);

}  // namespace disparityd::capture::recording
