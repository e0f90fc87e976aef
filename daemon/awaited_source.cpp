// SPDX-License-Identifier: Apache-2.0
#include "daemon/awaited_source.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "capture/source_condition.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;

/// Who waits for the first frame does not notice so little.
constexpr std::chrono::milliseconds between_looks{20};

}  // namespace

AwaitedSource::AwaitedSource(std::unique_ptr<capture::FrameSource> source, std::function<bool()> somebody_waits)
    : source_(std::move(source)), somebody_waits_(std::move(somebody_waits)) {
    if (source_->info().live) {
        throw std::invalid_argument("[source] start is \"on-client\", but the frames of " + source_->info().name +
                                    " come by the clock; allowed for recordings, folders and files. To match only "
                                    "while somebody wants frames: [pipeline] on_demand = true");
    }
}

capture::FrameSource::Next AwaitedSource::next(capture::RawFrame& frame, steady_clock::time_point deadline) {
    while (!has_begun_.load(std::memory_order_relaxed) && !somebody_waits_()) {
        const auto now = steady_clock::now();
        if (now >= deadline) {
            return Next::timeout;
        }
        std::unique_lock lock(mutex_);
        if (interruption_.wait_until(lock, std::min(deadline, now + between_looks), [this] { return interrupted_; })) {
            return source_->next(frame, deadline);  // the inner one was interrupted too, and says so
        }
    }
    has_begun_.store(true, std::memory_order_relaxed);
    return source_->next(frame, deadline);
}

void AwaitedSource::interrupt() noexcept {
    source_->interrupt();
    {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
    }
    interruption_.notify_all();
}

capture::SourceCondition AwaitedSource::condition() const {
    capture::SourceCondition condition = source_->condition();
    if (!has_begun_.load(std::memory_order_relaxed)) {
        condition.delivering = false;
        condition.detail = "the first frame waits for whoever wants frames ([source] start)";
    }
    return condition;
}

}  // namespace disparityd::daemon
