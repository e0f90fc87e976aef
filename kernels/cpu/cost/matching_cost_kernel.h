// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernels/cpu/census_layout.h"
#include "kernels/cpu/cost/single_row_costs.h"
#include "kernels/cpu/match_layout.h"

namespace disparityd::cpu {

/// Matching costs of row y from planes of all rows; those of row `next` are asked for, as they are needed soon.
/// `single`: where costs are averaged over rows, what this worker has of the same frame, else null. Where it is not
/// null, `streamed` gets the costs too, past the caches (hwy::FlushStream before another thread reads them): here,
/// where nothing else goes to memory, and not where paths are aggregated, or memory would have too little to do in one
/// of them and too much in the other.
using MatchingCostKernel = void (*)(const MatchGeometry& geometry, CensusPlanes<const std::uint8_t> planes, int y,
                                    int next, SingleRowCosts* single, std::uint8_t* costs, std::uint8_t* streamed);

}  // namespace disparityd::cpu
