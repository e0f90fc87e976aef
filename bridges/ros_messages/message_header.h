// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "formats/cdr_writer.h"

/// What many messages begin with or contain.
namespace disparityd::ros {

using formats::CdrWriter;

/// Writes a builtin_interfaces/msg/Time. `realtime_ns` is counted from 1970.
void write_time(CdrWriter& cdr, std::int64_t realtime_ns);

/// Writes a std_msgs/msg/Header. `realtime_ns` is counted from 1970.
void write_header(CdrWriter& cdr, std::int64_t realtime_ns, std::string_view frame);

/// A sensor_msgs/msg/RegionOfInterest. All zero: the whole image.
struct Region {
    std::uint32_t x = 0;       ///< px
    std::uint32_t y = 0;       ///< px
    std::uint32_t width = 0;   ///< px
    std::uint32_t height = 0;  ///< px
};

void write_region(CdrWriter& cdr, const Region& region);

}  // namespace disparityd::ros
