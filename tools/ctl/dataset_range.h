// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/command_line/match_arguments.h"

namespace disparityd::tools {

/// Returns how many candidates are searched where the command line says nothing: as many as the files of a dataset ask
/// for (tools/datasets/announced_range.h), else `usual`. A note tells of it, and of a range that does not reach as far
/// as these files say. `calibration` is the file given instead of the source's own; empty: none.
int dataset_disparities(const std::string& source, const std::string& calibration, const MatchArguments& match,
                        int usual);

}  // namespace disparityd::tools
