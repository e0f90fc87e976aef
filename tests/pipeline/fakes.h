// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <mutex>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/matcher.h"

namespace disparityd::pipeline::fakes {

inline constexpr int width = 8;
inline constexpr int height = 2;
/// For what comes in no time unless something is wrong.
inline constexpr std::chrono::seconds forever{60};

/// A source whose frames are pushed by the test, or made on demand up to a number; their first byte is the sequence.
class Source final : public capture::FrameSource {
public:
    explicit Source(std::uint64_t on_demand = 0, int loans = 64)
        : pixels_(static_cast<std::size_t>(loans)), on_demand_(on_demand) {
        info_.name = "fake";
        info_.eye_width = width;
        info_.height = height;
    }

    const capture::SourceInfo& info() const override { return info_; }

    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, deadline,
                            [&] { return interrupted_ || ended_ || failed_ || !queue_.empty() || on_demand_ > 0; });
        if (interrupted_) {
            return Next::interrupted;
        }
        if (queue_.empty() && made_ < on_demand_) {
            frame = make(made_++);
            return Next::frame;
        }
        if (!queue_.empty()) {
            frame = queue_.front();
            queue_.erase(queue_.begin());
            return Next::frame;
        }
        if (failed_) {
            throw std::runtime_error("fake.mkv: truncated after 3 frames");
        }
        return ended_ || on_demand_ > 0 ? Next::end : Next::timeout;
    }

    void give_back(const capture::RawFrame& frame) noexcept override {
        const std::lock_guard lock(mutex_);
        if (out_.erase(frame.loan) != 1) {
            ++wrong_returns_;
        }
    }

    void interrupt() noexcept override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_all();
    }

    /// Pushes a frame that brings samples; the caller keeps them.
    void push(std::uint64_t sequence, std::int64_t monotonic_ns, std::span<const capture::SensorSample> samples) {
        const std::lock_guard lock(mutex_);
        queue_.push_back(make(sequence));
        queue_.back().monotonic_ns = monotonic_ns;
        queue_.back().sensors = samples;
        changed_.notify_all();
    }
    void push(std::uint64_t sequence, std::uint32_t dropped_before = 0, std::uint32_t flags = 0) {
        const std::lock_guard lock(mutex_);
        queue_.push_back(make(sequence));
        queue_.back().dropped_before = dropped_before;
        queue_.back().flags = flags;
        changed_.notify_all();
    }
    void end() {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        changed_.notify_all();
    }
    void fail() {
        const std::lock_guard lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }
    /// Frames that the pipeline has on loan.
    std::size_t out() {
        const std::lock_guard lock(mutex_);
        return out_.size() - queue_.size();
    }
    /// Buffers in use, lent or waiting.
    std::size_t in_use() {
        const std::lock_guard lock(mutex_);
        return out_.size();
    }
    int wrong_returns() {
        const std::lock_guard lock(mutex_);
        return wrong_returns_;
    }

private:
    capture::RawFrame make(std::uint64_t sequence) {
        capture::RawFrame frame;
        int loan = 0;
        while (out_.contains(loan)) {
            ++loan;
        }
        out_.insert(loan);
        auto& pixels = pixels_.at(static_cast<std::size_t>(loan));
        pixels.fill(static_cast<std::uint8_t>(sequence));
        frame.image = {pixels.data(), PixelFormat::grey8, width, height, 2 * width};
        frame.sequence = sequence;
        frame.loan = loan;
        return frame;
    }

    capture::SourceInfo info_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<capture::RawFrame> queue_;
    std::vector<std::array<std::uint8_t, 2 * width * height>> pixels_;
    std::set<int> out_;
    std::uint64_t on_demand_;
    std::uint64_t made_ = 0;
    int wrong_returns_ = 0;
    bool interrupted_ = false;
    bool ended_ = false;
    bool failed_ = false;
};

/// Two stages: the first copies a raw byte, the second turns it into disparity; `hook` runs in front of each.
class Matcher final : public disparityd::Matcher {
public:
    explicit Matcher(std::function<void(int stage, const FrameView&)> hook = {}) : hook_(std::move(hook)) {
        config_.width = width;
        config_.height = height;
    }

    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return 64; }
    std::span<const StageInfo> stages() const override { return stages_; }

    void run(int stage, const FrameView& frame, Parallel&, std::span<std::chrono::nanoseconds> times) override {
        if (hook_) {
            hook_(stage, frame);
        }
        if (stage == 0) {
            std::memset(frame.left.data, frame.raw.data[0], static_cast<std::size_t>(width * height));
        } else {
            frame.disparity.at(0, 0) = frame.left.at(0, 0);
        }
        for (auto& time : times) {
            time = std::chrono::microseconds(5);
        }
    }

private:
    MatcherConfig config_;
    std::function<void(int, const FrameView&)> hook_;
    std::array<std::string_view, 1> rectify_{"rectify"};
    std::array<std::string_view, 2> match_{"dsi", "wta"};
    std::array<StageInfo, 2> stages_{StageInfo{StageKind::rectify, rectify_}, StageInfo{StageKind::match, match_}};
};

inline calibration::Rectification rectification() {
    calibration::Rectification rectification;
    rectification.width = width;
    rectification.height = height;
    return rectification;
}

}  // namespace disparityd::pipeline::fakes
