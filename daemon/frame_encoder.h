// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/frame_pool.h"

namespace disparityd {

/// Which part of a frame a client wants.
struct Selection {
    std::vector<v1::Product> products;
    struct Region {
        std::uint32_t x = 0;
        std::uint32_t y = 0;
        std::uint32_t width = 0;  ///< 0 = the whole image
        std::uint32_t height = 0;
        bool operator==(const Region&) const = default;
    } region;
    v1::Encoding encoding = v1::RAW;
    bool operator==(const Selection&) const = default;

    std::uint32_t product_bits() const;
};

/// What is wrong with the region for an image of this size, as "found ..., allowed: ..."; empty when nothing is.
std::string region_problem(const Selection::Region& region, std::uint32_t width, std::uint32_t height);

/// The planes of a frame as they go over a socket.
struct EncodedPlanes {
    std::vector<v1::PlaneInfo> planes;
    std::vector<std::uint8_t> bytes;  ///< all planes, one after the other
};

/// Cuts out and compresses. One thread uses an object at a time.
class FrameEncoder {
public:
    FrameEncoder();
    ~FrameEncoder();
    FrameEncoder(const FrameEncoder&) = delete;
    FrameEncoder& operator=(const FrameEncoder&) = delete;

    /// The region must lie within the frame, which must hold the products.
    EncodedPlanes encode(const FrameCopy& frame, const Selection& selection);

private:
    struct Compressor;
    std::unique_ptr<Compressor> compressor_;
    std::vector<std::uint8_t> cut_;  ///< a plane's region, before compression
};

}  // namespace disparityd
