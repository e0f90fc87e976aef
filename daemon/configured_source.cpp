// SPDX-License-Identifier: Apache-2.0
#include "daemon/configured_source.h"

#include <chrono>
#include <utility>

#include "calibration/calibration_lookup.h"
#include "daemon/awaited_source.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

/// Frames that a source lends beyond those in the pipeline's slots: one that the capture stage holds, one that may
/// replace it.
constexpr int spare_loans = 2;

}  // namespace

std::unique_ptr<capture::FrameSource> open_configured_source(const Config& config, const SourceCarryOver& carry_over,
                                                             std::function<void(int, int)> progress,
                                                             std::function<bool()> somebody_waits) {
    capture::SourceOptions options;
    options.uri = config.source.uri;
    options.loans = config.pipeline.slots + spare_loans;
    options.pace = config.source.pace;
    options.loop = config.source.loop;
    options.stamp = config.source.stamp;
    options.time_offset_us = config.source.time_offset_us;
    options.calibration_path = config.source.calibration;
    options.wait_for_camera = true;
    options.allow_unrectified = config.source.allow_unrectified;
    options.calibration_folders = calibration::folder_list(config.source.calibration_folders);
    options.controls = config.source.controls;
    options.control_overrides = carry_over.control_overrides;
    options.likely_port = carry_over.camera_port;
    options.sensors = config.source.sensors;
    options.stall_time = std::chrono::milliseconds(config.source.stall_ms);
    options.report = [](const std::string& line, bool trouble) {
        log_line(trouble ? LogLevel::warning : LogLevel::info, line);
    };
    options.progress = std::move(progress);
    std::unique_ptr<capture::FrameSource> source = capture::open_source(options);
    if (config.source.start == SourceStart::on_client) {
        return std::make_unique<AwaitedSource>(std::move(source), std::move(somebody_waits));
    }
    return source;
}

bool newest_wins(const Config& config, bool live) {
    return config.source.policy == PolicyChoice::live || (config.source.policy == PolicyChoice::automatic && live);
}

}  // namespace disparityd::daemon
