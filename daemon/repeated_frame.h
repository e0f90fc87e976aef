// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <semaphore>
#include <vector>

#include "capture/frame_source.h"

namespace disparityd::daemon {

/// A source that gives one picture several times: each time when let_go() has said that the one before is done with. So
/// what is measured between two calls of let_go() belongs to one frame.
class RepeatedFrame final : public capture::FrameSource {
public:
    /// `pixels`: both eyes side by side in the format of `info`, rows without gaps.
    RepeatedFrame(const capture::SourceInfo& info, std::vector<std::uint8_t> pixels, int times);

    const capture::SourceInfo& info() const override { return info_; }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame&) noexcept override {}
    void interrupt() noexcept override;

    /// Lets the next frame come, after the pause: frames that are rare find colder caches. Any thread, once for each.
    void let_go(std::chrono::nanoseconds pause);

private:
    const capture::SourceInfo info_;
    const std::vector<std::uint8_t> pixels_;
    const int times_;
    int given_ = 0;
    std::atomic<bool> interrupted_{false};
    std::atomic<std::chrono::steady_clock::time_point> not_before_{std::chrono::steady_clock::time_point::min()};
    std::counting_semaphore<> may_go_{1};
};

/// Returns how many bytes a row of a frame has, both eyes together.
std::size_t row_bytes(const capture::SourceInfo& info);

}  // namespace disparityd::daemon
