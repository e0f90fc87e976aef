// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/part_source.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/words.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

/// Some frames of a source. Threads as FrameSource.
class LimitedSource final : public capture::FrameSource {
public:
    /// Throws std::invalid_argument where the source has no frame of the range, as far as that is known.
    LimitedSource(std::unique_ptr<capture::FrameSource> source, FrameRange range);

    const capture::SourceInfo& info() const override { return info_; }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override { source_->interrupt(); }

private:
    std::unique_ptr<capture::FrameSource> source_;
    capture::SourceInfo info_;
    FrameRange range_;
    std::uint64_t left_;
    std::uint32_t lost_ = 0;  ///< before the next frame, since the last good one
};

LimitedSource::LimitedSource(std::unique_ptr<capture::FrameSource> source, FrameRange range)
    : source_(std::move(source)),
      info_(source_->info()),
      range_(std::move(range)),
      left_(range_.count.value_or(UINT64_MAX)) {
    if (info_.frame_count) {
        if (range_.first > 0 && range_.first >= *info_.frame_count) {
            throw std::invalid_argument("--first: found " + std::to_string(range_.first) + ", allowed: 0 .. " +
                                        std::to_string(*info_.frame_count - 1) + ", as " + info_.name + " has " +
                                        base::counted(*info_.frame_count, "frame"));
        }
        *info_.frame_count -= range_.first;
    }
    if (range_.count) {
        info_.frame_count = std::min(info_.frame_count.value_or(left_), left_);
    }
}

capture::FrameSource::Next LimitedSource::next(capture::RawFrame& frame,
                                               std::chrono::steady_clock::time_point deadline) {
    if (left_ == 0) {
        return Next::end;
    }
    Next got = source_->next(frame, deadline);
    for (; got == Next::frame && range_.first > 0; --range_.first) {
        const bool damaged = (frame.flags & capture::frame_flag_corrupt) != 0;  // these are in no run
        lost_ = damaged ? lost_ + frame.dropped_before + 1 : 0;                 // as the pipeline counts them
        if (range_.skipped && !damaged) {
            range_.skipped(frame);
        }
        source_->give_back(frame);
        got = source_->next(frame, deadline);
    }
    if (got == Next::frame) {
        --left_;
        frame.dropped_before += std::exchange(lost_, 0);
    }
    return got;
}

}  // namespace

std::unique_ptr<capture::FrameSource> open_part(const ProcessArguments& arguments,
                                                const capture::RunOfOneGeometry& part, FrameRange frames, int loans,
                                                std::function<void(const std::string&, bool)> report) {
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.first_image = part.first;
    options.image_count = part.count;
    options.skip_damaged = arguments.keep_going;
    options.report = std::move(report);
    options.loans = loans;
    options.pace = capture::Pace::fastest;
    options.calibration_path = arguments.calibration;
    options.time_offset_us = arguments.time_offset_us.value_or(0);
    auto source = open_with_progress(options);
    if (frames.first > 0 || frames.count) {
        return std::make_unique<LimitedSource>(std::move(source), std::move(frames));
    }
    return source;
}

std::optional<std::uint64_t> frames_of(const ProcessArguments& arguments) {
    return arguments.frames ? std::optional(static_cast<std::uint64_t>(*arguments.frames)) : std::nullopt;
}

}  // namespace disparityd::tools
