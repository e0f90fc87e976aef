// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/stream_clock.h"

#include <cstdint>

#include "kernels/cuda/device.h"

namespace disparityd::cuda {

StreamClock::StreamClock(std::size_t marks) : StreamClock() {
    events_.reserve(marks);
    while (events_.size() < marks) {
        cudaEvent_t event = nullptr;
        check(cudaEventCreate(&event), "creating an event");
        events_.push_back(event);
    }
}

StreamClock::~StreamClock() {
    for (const cudaEvent_t event : events_) {
        static_cast<void>(cudaEventDestroy(event));
    }
}

void StreamClock::mark(std::size_t i, const Stream& stream) const {
    cudaStreamCaptureStatus capture = cudaStreamCaptureStatusNone;
    check(cudaStreamIsCapturing(stream.get(), &capture), "taking the time");
    const unsigned flags = capture == cudaStreamCaptureStatusActive ? cudaEventRecordExternal : cudaEventRecordDefault;
    check(cudaEventRecordWithFlags(events_[i], stream.get(), flags), "taking the time");
}

std::chrono::nanoseconds StreamClock::after(std::size_t i) const {
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, events_[i], events_[i + 1]), "taking the time");
    return std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(milliseconds) * 1e6));
}

}  // namespace disparityd::cuda
