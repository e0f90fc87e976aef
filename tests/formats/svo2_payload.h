// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "tests/formats/svo2_picture.h"

struct AVCodecContext;

namespace disparityd::test {

/// What the video messages hold. The public description knows the first two; the others are what a lossless recording
/// may hold, and what nobody can read.
enum class Svo2Payload {
    h264,
    h265,
    h264_lossless,      ///< Annex B, 4:2:0, profile High 4:4:4 Predictive
    h264_lossless_444,  ///< the same with a chroma sample for each pixel
    h265_lossless,
    png,        ///< three colours, svo2_rgb()
    zstd_bgra,  ///< svo2_rgb() with alpha 255
    zstd_bgr,
    zstd_yuyv,  ///< the chroma of the row above on odd rows
    zstd_grey,
    encrypted,  ///< noise, as ciphertext is
};

/// Whether FFmpeg has an encoder for it here. The others need none.
bool can_write(Svo2Payload kind);

/// Makes the payloads of one file, frame by frame. Throws std::runtime_error where there is no encoder, or it fails.
class Svo2PayloadWriter {
public:
    /// A key frame comes every `key_distance` frames.
    Svo2PayloadWriter(Svo2Payload kind, int width, int height, int key_distance);
    ~Svo2PayloadWriter();
    Svo2PayloadWriter(const Svo2PayloadWriter&) = delete;
    Svo2PayloadWriter& operator=(const Svo2PayloadWriter&) = delete;

    struct Payload {
        std::string bytes;
        bool key = false;
    };
    /// All pictures have the size that the constructor got.
    Payload next(const Svo2Picture& picture);

private:
    struct CloseEncoder {
        void operator()(AVCodecContext* encoder) const;
    };
    Payload encoded(const Svo2Picture& picture);

    const Svo2Payload kind_;
    const int key_distance_;
    int frames_ = 0;
    std::unique_ptr<AVCodecContext, CloseEncoder> encoder_;
};

}  // namespace disparityd::test
