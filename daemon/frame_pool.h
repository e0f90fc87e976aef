// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "daemon/published_frame.h"

namespace disparityd {

/// A frame as the socket server keeps it: dense copies of the products that somebody wanted when it was made.
struct FrameCopy {
    proto::ShmFrame info{};
    std::chrono::steady_clock::time_point captured;
    std::chrono::steady_clock::time_point published;
    std::uint32_t products = 0;  ///< product_bit()s of the planes that hold something
    std::array<std::vector<std::uint8_t>, product_count + 1> planes;  ///< by number of the product
};

using FrameHandle = std::shared_ptr<const FrameCopy>;

/// A bounded number of frame copies, allocated beforehand. Any thread; handles may outlive the pool.
class FramePool {
public:
    FramePool(const StreamLayout& layout, std::size_t frames);

    /// A copy of the frame with the wanted products (product_bit()s); nullptr when all copies are in use.
    FrameHandle copy(const PublishedFrame& frame, std::uint32_t wanted);

private:
    struct State {
        std::mutex mutex;
        std::vector<std::unique_ptr<FrameCopy>> free;
    };
    std::vector<v1::Product> products_;
    std::shared_ptr<State> state_;
};

}  // namespace disparityd
