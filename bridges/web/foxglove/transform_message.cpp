// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/transform_message.h"

#include <array>

#include "bridges/web/foxglove/message_header.h"

namespace disparityd::foxglove {

Bytes optical_transform(std::int64_t realtime_ns) {
    CdrWriter cdr(192);
    cdr.length(1);
    write_header(cdr, realtime_ns, camera_frame);
    cdr.text(left_frame);
    cdr.f64_array(std::array{0.0, 0.0, 0.0});         // both are in the same place
    cdr.f64_array(std::array{-0.5, 0.5, -0.5, 0.5});  // x, y, z, w: a third of a turn about (-1, 1, -1)
    return cdr.take();
}

}  // namespace disparityd::foxglove
