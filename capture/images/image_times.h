// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// Reads KITTI's times of frames, in ns: timestamps.txt (a date and time of day per line, taken as UTC) or times.txt
/// (seconds per line). Throws std::invalid_argument with one line unless there are `count` of them that never go back.
std::vector<std::int64_t> read_image_times(const std::string& path, std::size_t count);

/// Returns the time in ns at the beginning of a line of EuRoC's data.csv, and takes it and the comma behind it from the
/// line. Nothing where no such time is there.
std::optional<std::int64_t> take_time(std::string_view& line);

}  // namespace disparityd::capture
