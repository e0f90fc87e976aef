// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "kernels/cuda/stream.h"

namespace disparityd::cuda {

/// Times between marks on a stream.
class StreamClock {
public:
    explicit StreamClock(std::size_t marks);
    ~StreamClock();
    StreamClock(const StreamClock&) = delete;
    StreamClock& operator=(const StreamClock&) = delete;

    /// On a stream whose operations a Graph takes, the mark becomes one of them.
    void mark(std::size_t i, const Stream& stream) const;
    /// From mark i to the next one, after the stream was waited for.
    std::chrono::nanoseconds after(std::size_t i) const;

private:
    StreamClock() = default;

    std::vector<cudaEvent_t> events_;
};

}  // namespace disparityd::cuda
