// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "capture/eye_layout.h"

namespace disparityd::capture {

/// Decodes the JPEGs of a camera (MJPEG) into frames of YUYV, both eyes side by side. The luma is that of the JPEG; the
/// chroma is that of the JPEG where it has half the columns, else the mean of two columns or a column twice. Rows of
/// chroma that stand for several rows of luma are repeated. The same JPEG gives the same bytes on every machine: the
/// transform is libjpeg's accurate one of integers, and nothing is smoothed. One thread.
class JpegDecoder {
public:
    /// Takes JPEGs of this size only. eye_width is even.
    explicit JpegDecoder(const EyeLayout& layout);
    ~JpegDecoder();
    JpegDecoder(const JpegDecoder&) = delete;
    JpegDecoder& operator=(const JpegDecoder&) = delete;

    /// Writes 4 * eye_width bytes for each row of an eye, without gaps. Returns nullptr, or for a JPEG that cannot be
    /// decoded in full why not, valid until the next call; what was written is then no picture. Every warning of
    /// libjpeg counts, because it fills up with grey what is missing.
    const char* decode(std::span<const std::uint8_t> jpeg, std::uint8_t* to);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace disparityd::capture
