// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "capture/sensor_sample.h"

/// Writes the samples of a frame as docs/recordings.md defines them: behind the frame's facts, their number first.
namespace disparityd::capture::recording {

/// Returns how many bytes put_sensors() fills.
std::size_t sensors_size(std::span<const SensorSample> samples);
void put_sensors(std::span<const SensorSample> samples, std::span<std::uint8_t> bytes);

/// Reads the samples behind a frame's facts; of longer samples of a later version, the fields known here. Returns
/// nullopt when the bytes are damaged. Any bytes may come; takes no more memory than a small multiple of them.
std::optional<std::vector<SensorSample>> get_sensors(std::span<const std::uint8_t> bytes);

/// Returns how many of the bytes behind a frame's facts the samples take; nothing where they do not fit in.
std::optional<std::size_t> stored_sensors_size(std::span<const std::uint8_t> bytes);

}  // namespace disparityd::capture::recording
