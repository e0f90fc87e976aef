// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/exposure_stamp.h"

namespace disparityd::capture {

std::optional<std::int64_t> ExposureStamp::to_centre_ns(const VideoStream& stream) {
    const auto now = system_.now();
    if (!asked_ || now - *asked_ >= interval) {
        asked_ = now;
        to_centre_ns_.reset();
        if (const auto exposure = stream.exposure()) {
            const std::int64_t half = exposure->count() / 2;
            to_centre_ns_ = system_.stamps_begin_exposure() ? half : -half;
        }
    }
    return to_centre_ns_;
}

}  // namespace disparityd::capture
