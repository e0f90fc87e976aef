// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "pipeline/worker_pool.h"
#include "tools/ctl/processing/process_arguments.h"
#include "tools/ctl/processing/process_report.h"

namespace disparityd::tools {

/// How the line of progress begins and ends.
struct Shown {
    std::string what = "frames";
    std::string more;
    /// Returns what is told of the time that is left, where that share of this source is done; may be empty.
    std::function<std::string(double share)> left = {};
};

/// Returns what the source of each part says of itself, without reading frames. Throws as process_source().
std::vector<capture::SourceInfo> infos_of(const ProcessArguments& arguments);

/// Processes arguments.source into arguments.folder, to its end or until Ctrl-C. Throws std::invalid_argument when the
/// user must change something, base::DiskFull or std::runtime_error when the system refuses, all before the first
/// frame; what ends it later is ProcessDone::error.
ProcessDone process_source(const ProcessArguments& arguments, pipeline::WorkerPool& workers, const Shown& shown);

}  // namespace disparityd::tools
