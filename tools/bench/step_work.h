// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kernels/options.h"

namespace disparityd::bench {

/// What a step of a matcher cannot do without, counted from docs/algorithm.md on paper.
struct StepWork {
    double bytes = 0;            ///< read and written beyond the caches: every image and volume once per use
    double byte_operations = 0;  ///< arithmetic on 8 bits; an operation on 16 bits counts as two
    double volume_bytes = 0;     ///< of that, what is written first and read later; 0 = nothing
};

/// Work of the step of that name (StageInfo::steps) on an image of `pixels`; empty for a step that nobody counted.
std::optional<StepWork> step_work(const std::string& step, const MatchOptions& options, double pixels);

/// How it is counted, lines for the reader.
std::string step_work_legend();

}  // namespace disparityd::bench
