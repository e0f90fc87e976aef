// SPDX-License-Identifier: Apache-2.0
#include "kernels/fallback_matcher.h"

#include <array>
#include <stdexcept>

namespace disparityd {

FallbackMatcher::FallbackMatcher(std::unique_ptr<Matcher> first, const Backend& second)
    : first_(std::move(first)), second_row_(second) {
    if (first_->stages().size() != 2) {
        throw std::logic_error("a matcher that can be replaced has two stages");
    }
}

void FallbackMatcher::run(int stage, const FrameView& frame, Parallel& workers,
                          std::span<std::chrono::nanoseconds> step_times) {
    if (!replaced_.load(std::memory_order_acquire)) {
        try {
            first_->run(stage, frame, workers, step_times);
            return;
        } catch (const std::runtime_error& error) {
            replace(error.what());
        }
    }
    run_second(stage, frame, workers, step_times);
}

std::string FallbackMatcher::trouble() const {
    const std::lock_guard lock(mutex_);
    return trouble_;
}

std::string_view FallbackMatcher::substitute() const {
    return replaced_.load(std::memory_order_acquire) ? second_row_.name : std::string_view();
}

void FallbackMatcher::replace(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (replaced_.load(std::memory_order_relaxed)) {
        return;  // the other stage came first
    }
    // Both or none: where there is no memory for the scratch, the next frame tries again.
    std::unique_ptr<Matcher> second = second_row_.create(first_->config());
    second_scratch_ = LargeBuffer(second->scratch_bytes());
    second_ = std::move(second);
    trouble_ = why + "; the back end " + std::string(second_row_.name) + " goes on";
    replaced_.store(true, std::memory_order_release);
}

void FallbackMatcher::run_second(int stage, const FrameView& frame, Parallel& workers,
                                 std::span<std::chrono::nanoseconds> step_times) {
    std::array<std::chrono::nanoseconds, 16> times{};
    if (stage == 0) {
        second_->run(0, frame, workers, step_times);
        return;
    }
    FrameView view = frame;
    view.scratch = {second_scratch_.data(), second_scratch_.size()};
    std::chrono::nanoseconds total{};
    const std::span<const StageInfo> stages = second_->stages();
    for (std::size_t i = 1; i < stages.size(); ++i) {
        const std::span<std::chrono::nanoseconds> used = std::span(times).first(stages[i].steps.size());
        second_->run(static_cast<int>(i), view, workers, used);
        for (const std::chrono::nanoseconds time : used) {
            total += time;
        }
    }
    for (std::chrono::nanoseconds& time : step_times) {
        time = {};
    }
    // The steps are the first matcher's: its winner step shows the whole time.
    step_times[this->stages()[static_cast<std::size_t>(stage)].winner_step] = total;
}

}  // namespace disparityd
