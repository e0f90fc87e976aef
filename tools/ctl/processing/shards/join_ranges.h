// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/ctl/processing/shards/split_source.h"

namespace disparityd::tools {

/// Makes one run of the ranges of a source once all are finished: moves their files into the folder of the source,
/// where they are as one run without ranges leaves them, and removes their folders. What is killed in the middle goes
/// on when it is called again. Returns how many frames there are; nothing where a range is not finished, or where
/// another process joins them at the moment. Throws std::invalid_argument where two ranges were made with other things,
/// and base::DiskFull or std::runtime_error when the system refuses.
std::optional<std::uint64_t> join_ranges(const SplitSource& source);

/// Removes what a join that was killed at its end has left of ranges; the source itself is finished.
void remove_joined_ranges(const std::string& folder);

}  // namespace disparityd::tools
