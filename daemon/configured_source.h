// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "capture/frame_source.h"
#include "daemon/config/config.h"

namespace disparityd::daemon {

/// What one source of a daemon passes to the next; see capture::SourceOptions.
struct SourceCarryOver {
    std::shared_ptr<capture::ControlOverrides> control_overrides;
    std::string camera_port;
};

/// Opens the source of a configuration, which reports its preparation by `progress`. With [source] start = "on-client"
/// it is an AwaitedSource, which asks `somebody_waits`. Throws as capture::open_source() and AwaitedSource.
std::unique_ptr<capture::FrameSource> open_configured_source(const Config& config, const SourceCarryOver& carry_over,
                                                             std::function<void(int done, int total)> progress,
                                                             std::function<bool()> somebody_waits);

/// Returns whether the newest frame goes before older ones that wait; `live`: what the source is.
bool newest_wins(const Config& config, bool live);

}  // namespace disparityd::daemon
