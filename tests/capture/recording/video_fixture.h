// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "capture/recording/recording_ffmpeg.h"

namespace disparityd::capture::test {

/// A video as another program writes it.
struct Video {
    const char* muxer;
    AVCodecID codec;
    AVPixelFormat pixels;
    int width;
    int height;
    int frames = 5;
    int tracks = 1;                                             ///< each with pictures of its own
    std::function<void(AVStream& stream, int track)> adjust{};  ///< before the header is written
};

constexpr int video_rate = 25;

/// What write_video() draws: the value of a component at a place. The second track is 60 brighter.
std::uint8_t value_at(int frame, int component, int x, int y);

void write_video(const std::string& path, const Video& video);

}  // namespace disparityd::capture::test
