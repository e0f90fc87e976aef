// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "tools/ctl/processing/process_arguments.h"
#include "tools/ctl/processing/process_report.h"

namespace disparityd::tools {

/// Returns what an earlier run has done where it has finished arguments.source in arguments.folder with the same
/// options, input, calibration and version; nothing where it has not, has left frames out, or where a file is missing
/// now. Changes nothing. Throws std::invalid_argument with one line where a run in it, finished or not, was made of or
/// with anything else.
std::optional<ProcessDone> finished_before(const ProcessArguments& arguments);

}  // namespace disparityd::tools
