// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::test {

/// Step 3 of both images, median milliseconds, by the memory that the windows are read from; the first two are the
/// paper's alternatives (tests/cuda/census_variants.h), the last is what kernels/cuda does.
struct CensusTimes {
    double global_memory, texture_memory, shared_memory;
};
CensusTimes census_times(int width, int height);

/// Step 1 of both eyes from YUYV through maps, median milliseconds, all of it in the device's memory.
double rectify_time(int width, int height);

}  // namespace disparityd::test
