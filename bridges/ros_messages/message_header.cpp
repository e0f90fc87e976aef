// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/message_header.h"

namespace disparityd::ros {

void write_time(CdrWriter& cdr, std::int64_t realtime_ns) {
    constexpr std::int64_t second = 1'000'000'000;
    std::int64_t seconds = realtime_ns / second;
    std::int64_t rest = realtime_ns % second;
    if (rest < 0) {  // nanoseconds count upwards before 1970, too
        rest += second;
        --seconds;
    }
    cdr.i32(static_cast<std::int32_t>(seconds)).u32(static_cast<std::uint32_t>(rest));
}

void write_header(CdrWriter& cdr, std::int64_t realtime_ns, std::string_view frame) {
    write_time(cdr, realtime_ns);
    cdr.text(frame);
}

void write_region(CdrWriter& cdr, const Region& region) {
    // The fields' order is that of the definition; the last one says whether a rectified image needs another region.
    cdr.u32(region.x).u32(region.y).u32(region.height).u32(region.width).boolean(false);
}

}  // namespace disparityd::ros
