// SPDX-License-Identifier: Apache-2.0
#include "daemon/published_frame.h"

namespace disparityd {

v1::Geometry to_message(const proto::ShmFrame& geometry) {
    v1::Geometry message;
    message.set_width(geometry.width);
    message.set_height(geometry.height);
    message.set_f(geometry.f);
    message.set_cx(geometry.cx);
    message.set_cy(geometry.cy);
    message.set_baseline_mm(geometry.baseline_mm);
    message.set_disparity_offset(geometry.disparity_offset);
    message.set_d_min(geometry.d_min);
    message.set_disparities(geometry.disparities);
    message.set_invalid(geometry.invalid);
    message.set_calibration_id(geometry.calibration_id);
    return message;
}

}  // namespace disparityd
