// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/sensor_sample.h"

/// Writes the samples of a frame as docs/recordings.md defines them: behind the frame's facts, and only where there are
/// some, so that recordings without sensors keep their format.
namespace disparityd::capture::recording {

/// Returns how many bytes put_sensors() fills: 0 without samples.
std::size_t sensors_size(std::span<const SensorSample> samples);
void put_sensors(std::span<const SensorSample> samples, std::span<std::uint8_t> bytes);

/// Reads the samples behind a frame's facts; of longer samples of a later version, the fields known here. Returns
/// nullopt when the bytes are damaged. Any bytes may come; takes no more memory than a small multiple of them.
std::optional<std::vector<SensorSample>> get_sensors(std::span<const std::uint8_t> bytes);

}  // namespace disparityd::capture::recording
