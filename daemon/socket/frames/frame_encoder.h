// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/socket/frames/frame_pool.h"
#include "daemon/socket/frames/payload.h"

namespace disparityd::daemon {

/// The products, the region and the encoding that a client wants of a frame.
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

/// Returns why the region does not fit an image of this size, as "found ..., allowed: ..."; empty if it fits.
std::string region_problem(const Selection::Region& region, std::uint32_t width, std::uint32_t height);

/// The planes of a frame as they go over a socket.
struct EncodedPlanes {
    std::vector<v1::PlaneInfo> planes;
    Payload bytes;  ///< of all planes in order, at most one part each
};

/// Makes the planes that a client wants of a frame. Full rows stay in the frame: they are not copied for a raw frame,
/// and zstd reads them from there. Other regions are copied first. One thread uses an object at a time.
class FrameEncoder {
public:
    FrameEncoder();
    ~FrameEncoder();
    FrameEncoder(const FrameEncoder&) = delete;
    FrameEncoder& operator=(const FrameEncoder&) = delete;

    /// The region must lie within the frame, and the frame must have the products. The result may hold the frame.
    /// Throws std::bad_alloc, or std::runtime_error if zstd fails.
    EncodedPlanes encode(const FrameHandle& frame, const Selection& selection);

private:
    struct Compressor;
    EncodedPlanes compress(const FrameCopy& frame, const Selection& selection, const Selection::Region& region,
                           bool whole_rows);

    std::unique_ptr<Compressor> compressor_;
    std::vector<std::uint8_t> cut_;  ///< a plane's region, before compression
};

}  // namespace disparityd::daemon
