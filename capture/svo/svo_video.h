// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "capture/recording/recording_ffmpeg.h"
#include "capture/recording/recording_pixels.h"
#include "capture/svo/annex_b.h"
#include "capture/svo/svo_picture.h"

namespace disparityd::capture {

/// Decodes the access units of an H.264 or H.265 video of both eyes. One thread uses an object at a time.
class SvoVideo {
public:
    /// Throws std::invalid_argument when this FFmpeg cannot decode it; `path` is for messages.
    SvoVideo(AnnexBCodec codec, const std::string& path);

    /// Gives the next access unit to the decoder, under a number that rises. Throws std::runtime_error with what is
    /// wrong with it.
    void send(std::span<const std::uint8_t> unit, std::int64_t number);

    /// Tells the decoder that no more units come; receive() then gives what it has kept.
    void end();

    struct Decoded {
        std::int64_t number = 0;  ///< of its access unit
        SvoPicture picture;
    };

    /// Returns the next picture, if the decoder has one. Throws std::runtime_error with what is wrong with it.
    std::optional<Decoded> receive();

private:
    void open_loader();

    CodecPtr decoder_;
    PacketPtr packet_;
    FramePtr frame_;
    std::unique_ptr<PixelLoader> loader_;
    SvoSize loader_size_;
    int loader_format_ = -1;
};

}  // namespace disparityd::capture
