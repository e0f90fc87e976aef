// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::foxglove {

/// One plane of one or three bytes per pixel (grey, BGR) as JPEG.
class JpegImage {
public:
    /// Compresses; `quality` is 1 .. 100. The plane has the bytes that its size asks for.
    JpegImage(const disparity::PlaneData& plane, int quality);
    ~JpegImage();
    JpegImage(const JpegImage&) = delete;
    JpegImage& operator=(const JpegImage&) = delete;

    /// Returns the file's bytes; none when the image cannot be one, because a side has more than 65500 px.
    std::span<const std::uint8_t> bytes() const { return {data_, size_}; }

private:
    unsigned char* data_ = nullptr;
    unsigned long size_ = 0;
};

}  // namespace disparityd::foxglove
