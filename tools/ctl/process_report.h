// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/depth_range.h"
#include "pipeline/calibrating_schedule.h"
#include "tools/ctl/trust_summary.h"

namespace disparityd::tools {

/// What `process` has done.
struct ProcessDone {
    std::string source;
    std::string folder;
    std::vector<std::string> left_out;                           ///< damaged images, one line each
    const pipeline::CalibratingSchedule* calibrating = nullptr;  ///< where it estimated
    std::vector<std::string> distances;                          ///< for people, a line for each size
    std::optional<calibration::DepthRange> range;                ///< where all frames have one
    std::uint64_t damaged = 0;
    std::string error;  ///< why it ended early; empty: it did not
    std::uint64_t frames = 0;
    double seconds = 0;
    std::optional<double> measured;  ///< share of the pixels; nothing where limits of distance reject some
    std::string empty_note;          ///< where hardly any were
    TrustSummary trust;
};

/// Prints the summary, as one JSON object or for people, and what went wrong; returns the exit status.
int report_process(const ProcessDone& done, bool json);

}  // namespace disparityd::tools
