// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>

#include "capture/frame_source.h"

namespace disparityd::daemon {

/// A source that begins with its first client: [source] start = "on-client". What it gives and says is the inner one's;
/// until then condition() says that it waits.
class AwaitedSource : public capture::FrameSource {
public:
    /// `somebody_waits` is asked in the thread that calls next(), every 20 ms until it says true. Throws
    /// std::invalid_argument for a live source, whose frames do not wait.
    AwaitedSource(std::unique_ptr<capture::FrameSource> source, std::function<bool()> somebody_waits);

    const capture::SourceInfo& info() const override { return source_->info(); }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override;
    capture::SourceCondition condition() const override;

private:
    const std::unique_ptr<capture::FrameSource> source_;
    const std::function<bool()> somebody_waits_;
    std::atomic<bool> has_begun_{false};
    std::mutex mutex_;
    std::condition_variable interruption_;
    bool interrupted_ = false;
};

}  // namespace disparityd::daemon
