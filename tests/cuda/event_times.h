// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "kernels/cuda/runtime.h"

namespace disparityd::test {

/// Median seconds that operation(round) takes on the stream, of 21 rounds.
template <typename Operation>
double seconds_of(const cuda::Stream& stream, Operation operation) {
    const cuda::StreamClock clock(2);
    std::vector<double> times;
    for (int round = 0; round < 21; ++round) {
        clock.mark(0, stream);
        operation(round);
        clock.mark(1, stream);
        stream.wait("what is timed");
        times.push_back(std::chrono::duration<double>(clock.after(0)).count());
    }
    std::nth_element(times.begin(), times.begin() + 10, times.end());
    return times[10];
}

}  // namespace disparityd::test
