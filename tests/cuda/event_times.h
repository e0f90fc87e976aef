// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "kernels/cuda/stream_clock.h"

namespace disparityd::test {

/// Median seconds that operation(i) takes on the stream, i from 0 on. Eight at a time, so that the device does not wait
/// for the host to ask.
template <typename Operation>
double seconds_of(const cuda::Stream& stream, Operation operation) {
    constexpr int at_a_time = 8;
    constexpr int rounds = 21;
    const cuda::StreamClock clock(2);
    std::vector<double> times;
    for (int round = 0; round < rounds; ++round) {
        clock.mark(0, stream);
        for (int i = 0; i < at_a_time; ++i) {
            operation(round * at_a_time + i);
        }
        clock.mark(1, stream);
        stream.wait("what is timed");
        times.push_back(std::chrono::duration<double>(clock.after(0)).count() / at_a_time);
    }
    std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
    return times[rounds / 2];
}

}  // namespace disparityd::test
