// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "capture/recording/recording_ffmpeg.h"
#include "kernels/raw_image.h"

struct SwsContext;

namespace disparityd::capture {

/// Returns the codec's pixel format that holds ours without loss.
AVPixelFormat stored_format(PixelFormat format);

/// Copies a captured frame into a frame of stored_format(), both eyes side by side.
void store_pixels(const RawImage& image, AVFrame& frame);

/// Copies decoded frames into ours. YUV 4:2:2 of 8 bits becomes yuyv, RGB becomes bgr24, of everything else the luma
/// is taken as grey8. One thread uses an object at a time.
class PixelLoader {
public:
    /// Throws std::invalid_argument, without the file's name, when the pictures cannot be taken.
    PixelLoader(AVPixelFormat stored, int width, int height);

    PixelFormat format() const { return format_; }

    /// Writes width x height pixels to `to`, rows without gaps. The frame must be as the constructor was told.
    void load(const AVFrame& frame, std::uint8_t* to);

private:
    struct FreeScaler {
        void operator()(SwsContext* scaler) const;
    };
    enum class Way { pack_422, interleave_gbr, copy_rows, scale };
    void copy_rows(const AVFrame& frame, std::uint8_t* to) const;

    Way way_ = Way::copy_rows;
    PixelFormat format_ = PixelFormat::grey8;
    int width_;
    int height_;
    std::unique_ptr<SwsContext, FreeScaler> scaler_;
    FramePtr scaled_;  ///< the scaler writes past short rows, so it gets a frame of its own
};

}  // namespace disparityd::capture
