// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "daemon/published_frame.h"

namespace disparityd::daemon {

/// A frame of the socket server: dense copies of the products that any client wanted when it was made.
struct FrameCopy {
    proto::FrameInfo info{};
    std::chrono::steady_clock::time_point captured;
    std::chrono::steady_clock::time_point published;
    std::uint32_t products = 0;                                       ///< product_bit()s of the planes that are filled
    std::array<std::vector<std::uint8_t>, product_count + 1> planes;  ///< by number of the product
    std::array<ProductShape, product_count + 1> shapes{};             ///< of the planes
};

using FrameHandle = std::shared_ptr<const FrameCopy>;

/// A fixed number of frame copies, allocated by the constructor. Any thread; handles may outlive the pool.
class FramePool {
public:
    FramePool(const StreamLayout& layout, std::size_t frames);

    /// Returns a copy of the frame with the wanted products (product_bit()s), or nullptr if all copies are in use.
    FrameHandle copy(const PublishedFrame& frame, std::uint32_t wanted);

private:
    struct State {
        std::mutex mutex;
        std::vector<std::unique_ptr<FrameCopy>> free;
    };
    std::vector<v1::Product> products_;
    std::shared_ptr<State> state_;
};

}  // namespace disparityd::daemon
