// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "kernels/large_buffer.h"
#include "kernels/matcher.h"

namespace disparityd {

/// A matcher that may fail in mid-stream (a device can be lost), and a back end that goes on in its place: from the
/// frame on that failed, none is missing. Which one computed a frame cannot be seen in it, because all give the same
/// bytes.
class FallbackMatcher final : public Matcher {
public:
    /// `first` has two stages, `rectify` and one for the rest; these remain the stages. What `second` needs is taken
    /// when it is needed.
    FallbackMatcher(std::unique_ptr<Matcher> first, const Backend& second);

    const MatcherConfig& config() const override { return first_->config(); }
    std::size_t scratch_bytes() const override { return first_->scratch_bytes(); }
    std::span<const StageInfo> stages() const override { return first_->stages(); }
    bool computes_on_workers() const override { return first_->computes_on_workers(); }
    /// Lets std::invalid_argument through: that is the caller's mistake, on every back end. Throws std::runtime_error
    /// when the second matcher cannot be made either; the next call tries again.
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override;
    std::string trouble() const override;
    std::string_view substitute() const override;

private:
    void replace(const std::string& why);
    void run_second(int stage, const FrameView& frame, Parallel& workers,
                    std::span<std::chrono::nanoseconds> step_times);

    std::unique_ptr<Matcher> first_;  // kept: another thread may still be in it
    const Backend& second_row_;
    mutable std::mutex mutex_;
    std::string trouble_;
    std::unique_ptr<Matcher> second_;
    LargeBuffer second_scratch_;
    std::atomic<bool> replaced_ = false;
};

/// A matcher in the place of another one that could not be made, which says so.
class SubstituteMatcher final : public Matcher {
public:
    SubstituteMatcher(const Backend& row, const MatcherConfig& config, const std::string& why)
        : name_(row.name),
          matcher_(row.create(config)),
          trouble_(why + "; the back end " + std::string(row.name) + " is used") {}

    const MatcherConfig& config() const override { return matcher_->config(); }
    std::size_t scratch_bytes() const override { return matcher_->scratch_bytes(); }
    std::span<const StageInfo> stages() const override { return matcher_->stages(); }
    bool computes_on_workers() const override { return matcher_->computes_on_workers(); }
    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override {
        matcher_->run(stage, frame, workers, step_times);
    }
    std::string trouble() const override { return trouble_; }
    std::string_view substitute() const override { return name_; }

private:
    std::string_view name_;
    std::unique_ptr<Matcher> matcher_;
    std::string trouble_;
};

}  // namespace disparityd
