// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/published_frame.h"

namespace disparityd::test {

/// Returns every product, in the order of their numbers.
std::vector<v1::Product> all_products();

/// Frames without a pipeline: each plane of frame n is filled with a pattern that names n, product and position.
class PatternFrames {
public:
    PatternFrames(std::uint32_t width, std::uint32_t height, std::vector<v1::Product> products);

    const daemon::StreamLayout& layout() const { return layout_; }

    /// Valid until the next call.
    daemon::PublishedFrame next();

    /// The dense bytes of a product's region in frame n; all bytes of a record.
    static std::vector<std::uint8_t> expected(std::uint64_t n, v1::Product product, std::uint32_t x, std::uint32_t y,
                                              std::uint32_t width, std::uint32_t height);

private:
    daemon::StreamLayout layout_;
    std::uint64_t next_ = 0;
    std::vector<std::vector<std::uint8_t>> planes_;
};

}  // namespace disparityd::test
