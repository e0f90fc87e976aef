// SPDX-License-Identifier: Apache-2.0
#include "daemon/repeated_frame.h"

#include <thread>
#include <utility>

namespace disparityd::daemon {

using std::chrono::nanoseconds;

std::size_t row_bytes(const capture::SourceInfo& info) {
    return 2 * static_cast<std::size_t>(info.eye_width) * static_cast<std::size_t>(bytes_per_pixel(info.format));
}

RepeatedFrame::RepeatedFrame(const capture::SourceInfo& info, std::vector<std::uint8_t> pixels, int times)
    : info_(info), pixels_(std::move(pixels)), times_(times) {}

capture::FrameSource::Next RepeatedFrame::next(capture::RawFrame& frame,
                                               std::chrono::steady_clock::time_point deadline) {
    if (given_ == times_) {
        return Next::end;
    }
    if (!may_go_.try_acquire_until(deadline)) {
        return Next::timeout;
    }
    std::this_thread::sleep_until(not_before_.load());
    if (interrupted_.load()) {
        return Next::interrupted;
    }
    frame = {};
    frame.image = {.data = pixels_.data(),
                   .format = info_.format,
                   .eye_width = info_.eye_width,
                   .height = info_.height,
                   .stride = static_cast<std::ptrdiff_t>(row_bytes(info_))};
    frame.sequence = static_cast<std::uint64_t>(given_);
    frame.monotonic_ns = nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
    frame.flags = given_ == 0 ? std::uint32_t{capture::frame_flag_discontinuity} : 0U;
    ++given_;
    return Next::frame;
}

void RepeatedFrame::let_go(nanoseconds pause) {
    not_before_.store(std::chrono::steady_clock::now() + pause);
    may_go_.release();
}

void RepeatedFrame::interrupt() noexcept {
    interrupted_.store(true);
    may_go_.release();
}

}  // namespace disparityd::daemon
