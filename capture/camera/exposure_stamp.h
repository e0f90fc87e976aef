// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "capture/camera/video_stream.h"

namespace disparityd::capture {

/// Says how far the centre of a frame's exposure is from the driver's stamp: half the exposure that the driver reports.
/// One thread uses it, the one of the stream.
class ExposureStamp {
public:
    explicit ExposureStamp(VideoSystem& system) : system_(system) {}

    /// Asks anew at the next call: the stream is another one.
    void forget() { asked_.reset(); }

    /// Returns nanoseconds that are to be added to a stamp of now; nothing where the driver reports no exposure. The
    /// driver is asked once in `interval`, which takes a few milliseconds.
    std::optional<std::int64_t> to_centre_ns(const VideoStream& stream);

    static constexpr std::chrono::milliseconds interval{500};

private:
    VideoSystem& system_;
    std::optional<std::chrono::steady_clock::time_point> asked_;
    std::optional<std::int64_t> to_centre_ns_;
};

}  // namespace disparityd::capture
