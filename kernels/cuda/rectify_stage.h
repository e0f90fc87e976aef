// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "kernels/cuda/memory.h"
#include "kernels/cuda/stream.h"
#include "kernels/matcher.h"

namespace disparityd::cuda {

/// The first stage on the device: raw frame in, rectified pair (and colour) out, all in host memory.
class RectifyStage {
public:
    RectifyStage(int width, int height);

    /// The frame's own memory for the raw picture is taken when the first one comes, and again when its size changes.
    void run(const FrameView& frame, Parallel& workers);

private:
    void upload_raw(const RawImage& raw, Parallel& workers);
    void upload_maps(const Rectifier& rectifier);

    int width_;
    int height_;
    PinnedBuffer raw_;
    std::array<DeviceMemory, 2> xy_;
    std::array<DeviceMemory, 2> fraction_;
    std::uint64_t maps_id_ = 0;  // of those on the device; 0: none that may be used again
    std::array<PinnedBuffer, 2> out_;
    std::array<PinnedBuffer, 2> colour_;
    Stream stream_;  // the last one, so that what runs on it ends before the memory goes
};

}  // namespace disparityd::cuda
