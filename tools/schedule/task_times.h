// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/parallel.h"
#include "tools/schedule/simulation.h"

namespace disparityd::schedule {

/// What is matched: a noise image with P2 63 and all 8 paths.
struct Frame {
    int width = 0;
    int height = 0;
    int disparities = 0;
    std::int64_t target = 0;      ///< instruction set, as sgm_kernels() has it
    std::size_t cache_bytes = 0;  ///< as SgmSweeps has it
};

/// Medians over the groups of a frame that one core works on alone, divided as for this many workers.
TaskTimes measure_alone(const Frame& frame, int workers);

/// What aggregation takes longer when two cores take every other group of a sweep, one at a time, so that what the row
/// before left is in the other core's cache; 1 = nothing. Both cores should be idle otherwise.
double measure_handing_over(const Frame& frame);

/// SgmSweeps::match() with real workers: the median of some frames, in microseconds.
double measure_frame(const Frame& frame, Parallel& workers);

/// The plan of SgmSweeps for this frame.
Division division_of(const Frame& frame, int workers);

}  // namespace disparityd::schedule
