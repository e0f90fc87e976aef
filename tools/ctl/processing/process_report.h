// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/depth_range.h"
#include "clients/json/message_json.h"
#include "pipeline/calibrating_schedule.h"
#include "tools/ctl/trust_summary.h"

namespace disparityd::tools {

/// What `process` has done.
struct ProcessDone {
    std::string source;
    std::string folder;
    std::vector<std::string> left_out;                                              ///< damaged images, one line each
    std::optional<std::vector<pipeline::CalibratingSchedule::Estimate>> estimates;  ///< where it estimated
    std::vector<std::string> distances;            ///< for people, a line for each size
    std::optional<calibration::DepthRange> range;  ///< where all frames have one
    std::uint64_t damaged = 0;
    std::string error;    ///< why it ended early; empty: it did not
    bool again = false;   ///< that was a full disk
    std::string refusal;  ///< why it did not begin; empty: it did
    int status = 0;       ///< exit status of a refusal
    bool before = false;  ///< an earlier run did all of it
    std::uint64_t frames = 0;
    double seconds = 0;
    std::optional<double> measured;  ///< share of the pixels; nothing where limits of distance reject some
    std::string empty_note;          ///< where hardly any were
    TrustSummary trust;
};

/// Prints the summary, as one JSON object or for people, and what went wrong; returns the exit status.
int report_process(const ProcessDone& done, bool json);

/// Tells of the sources of a list, and counts them. One thread uses it.
class ListReport {
public:
    ListReport(std::string folder, std::size_t sources, bool json);

    /// Tells of one source that was tried; returns its exit status.
    int add(const ProcessDone& done);

    std::size_t failed() const { return failed_; }

    /// Prints the sums, and what is left; returns the exit status of all.
    int finish();

private:
    std::string folder_;
    std::size_t sources_;
    bool json_;
    json::Json each_ = json::Json::array();
    std::size_t tried_ = 0;
    std::size_t failed_ = 0;
    std::size_t before_ = 0;
    std::uint64_t frames_ = 0;
    double seconds_ = 0;
    int status_ = 0;  ///< of the failure that counts most
};

}  // namespace disparityd::tools
