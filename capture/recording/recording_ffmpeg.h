// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <memory>
#include <new>
#include <string>

namespace disparityd::capture {

struct FfmpegDelete {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
using FramePtr = std::unique_ptr<AVFrame, FfmpegDelete>;
using PacketPtr = std::unique_ptr<AVPacket, FfmpegDelete>;
using CodecPtr = std::unique_ptr<AVCodecContext, FfmpegDelete>;

/// Throws where FFmpeg's constructors return null, which means that memory ran out.
template <typename T>
T* or_bad_alloc(T* made) {
    if (made == nullptr) {
        throw std::bad_alloc();
    }
    return made;
}

/// Takes FFmpeg's log away from stderr, for the whole process: its last error message of each thread is kept for
/// ffmpeg_reason() instead. Cheap to call again.
void keep_ffmpeg_log();

/// Forgets the message kept for this thread.
void clear_ffmpeg_log() noexcept;

/// Says what an FFmpeg error code means, with the message that this thread's last call logged, in one line.
std::string ffmpeg_reason(int error);

}  // namespace disparityd::capture
