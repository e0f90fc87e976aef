// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "capture/sensor_sample.h"
#include "clients/cpp/disparity_client.hpp"
#include "pipeline/frame_slot.h"
#include "products/frame_info.h"

namespace disparityd::tools {

/// What is copied of a slot.
struct SlotContents {
    const std::vector<disparity::Product>& products;
    std::span<const std::byte> scan;  ///< the record of the product scan; empty: none
    std::uint32_t flags = 0;          ///< those that added stages give the frame
};

/// Fills a frame as a client of the daemon would get it, but for publish_index and ages. `range` is that of the
/// matcher.
void put_slot(disparity::Frame& frame, const pipeline::FrameSlot& slot, DisparityRange range,
              const products::FrameFacts& facts, const SlotContents& contents);

/// Returns a sample as a client of the daemon would get it.
disparity::SensorSample client_sample(const capture::SensorSample& sample);

}  // namespace disparityd::tools
