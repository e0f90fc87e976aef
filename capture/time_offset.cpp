// SPDX-License-Identifier: Apache-2.0
#include "capture/time_offset.h"

#include <string>
#include <utility>

#include "capture/camera_setting.h"
#include "capture/source_condition.h"

namespace disparityd::capture {

namespace {

/// A damaged file may have any stamp: where the sum has no room it wraps, as it would on a clock.
std::int64_t later(std::int64_t time_ns, std::int64_t offset_us) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns) +
                                     static_cast<std::uint64_t>(offset_us * 1000));
}

class OffsetSource final : public FrameSource {
public:
    OffsetSource(std::unique_ptr<FrameSource> source, int offset_us)
        : source_(std::move(source)), info_(source_->info()), offset_us_(offset_us) {
        info_.time_offset_us = offset_us;
    }

    const SourceInfo& info() const override { return info_; }

    Next next(RawFrame& frame, std::chrono::steady_clock::time_point deadline) override {
        const Next got = source_->next(frame, deadline);
        if (got == Next::frame) {
            frame.monotonic_ns = later(frame.monotonic_ns, offset_us_);
            frame.realtime_ns = later(frame.realtime_ns, offset_us_);
        }
        return got;
    }

    void give_back(const RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override { source_->interrupt(); }
    SourceCondition condition() const override { return source_->condition(); }
    std::vector<CameraControl> set_camera_controls(const std::vector<CameraSetting>& settings) override {
        return source_->set_camera_controls(settings);
    }

private:
    const std::unique_ptr<FrameSource> source_;
    SourceInfo info_;
    const std::int64_t offset_us_;
};

}  // namespace

std::unique_ptr<FrameSource> with_time_offset(std::unique_ptr<FrameSource> source, const SourceOptions& options) {
    const int contained = source->info().time_offset_us;
    if (options.time_offset_us == 0) {
        return source;
    }
    if (contained != 0) {
        if (options.report) {
            options.report("source " + options.uri + ": its stamps contain an offset of " + std::to_string(contained) +
                               " us since they were recorded; time_offset_us = " +
                               std::to_string(options.time_offset_us) + " is not added",
                           contained != options.time_offset_us);
        }
        return source;
    }
    return std::make_unique<OffsetSource>(std::move(source), options.time_offset_us);
}

}  // namespace disparityd::capture
