// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/svo2_payload.h"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <zstd.h>

#include "capture/recording/recording_ffmpeg.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace disparityd::test {
namespace {

using capture::FramePtr;
using capture::PacketPtr;

const char* encoder_name(Svo2Payload kind) {
    switch (kind) {
        case Svo2Payload::h264:
        case Svo2Payload::h264_lossless:
        case Svo2Payload::h264_lossless_444: return "libx264";
        case Svo2Payload::h265:
        case Svo2Payload::h265_lossless: return "libx265";
        case Svo2Payload::png: return "png";
        default: return nullptr;
    }
}

AVPixelFormat pixels_of(Svo2Payload kind) {
    switch (kind) {
        case Svo2Payload::png: return AV_PIX_FMT_RGB24;
        case Svo2Payload::h264_lossless_444: return AV_PIX_FMT_YUV444P;
        default: return AV_PIX_FMT_YUV420P;
    }
}

void must(int result, const char* what) {
    if (result < 0) {
        throw std::runtime_error(std::string("SVO2 test file: FFmpeg cannot ") + what);
    }
}

void choose(AVCodecContext& encoder, const char* key, const char* value) {
    must(av_opt_set(encoder.priv_data, key, value, 0), key);
}

/// One packet comes out for each picture that goes in, without B frames, as from a camera's encoder.
void set_up(AVCodecContext& encoder, Svo2Payload kind) {
    encoder.max_b_frames = 0;
    encoder.thread_count = 1;
    if (kind == Svo2Payload::png) {
        return;
    }
    choose(encoder, "preset", "ultrafast");
    choose(encoder, "tune", "zerolatency");
    if (kind == Svo2Payload::h265 || kind == Svo2Payload::h265_lossless) {
        const std::string quality = kind == Svo2Payload::h265 ? "crf=18" : "lossless=1";
        choose(encoder, "x265-params", ("log-level=none:pools=none:frame-threads=1:" + quality).c_str());
    } else {
        choose(encoder, kind == Svo2Payload::h264 ? "crf" : "qp", kind == Svo2Payload::h264 ? "18" : "0");
    }
}

/// A sample of `samples` is for `made` x `made` pixels, one of the frame for `kept` x `kept`.
void fill_plane(AVFrame& frame, int plane, const std::vector<std::uint8_t>& samples, int made, int kept) {
    const int width = frame.width / made;
    for (int y = 0; y < frame.height; y += kept) {
        for (int x = 0; x < frame.width; x += kept) {
            frame.data[plane][y / kept * frame.linesize[plane] + x / kept] =
                samples[static_cast<std::size_t>(y / made * width + x / made)];
        }
    }
}

FramePtr frame_of(const Svo2Picture& picture, AVPixelFormat pixels) {
    FramePtr frame(capture::or_bad_alloc(av_frame_alloc()));
    frame->width = picture.width;
    frame->height = picture.height;
    frame->format = pixels;
    must(av_frame_get_buffer(frame.get(), 0), "make a frame");
    if (pixels == AV_PIX_FMT_RGB24) {
        const std::vector<std::uint8_t> rgb = svo2_rgb(picture);
        for (int y = 0; y < picture.height; ++y) {
            std::copy_n(rgb.begin() + 3L * y * picture.width, 3L * picture.width,
                        frame->data[0] + y * frame->linesize[0]);
        }
    } else {
        const int kept = pixels == AV_PIX_FMT_YUV444P ? 1 : 2;
        fill_plane(*frame, 0, picture.luma, 1, 1);
        fill_plane(*frame, 1, picture.blue, 2, kept);
        fill_plane(*frame, 2, picture.red, 2, kept);
    }
    return frame;
}

std::string raw(const Svo2Picture& picture, Svo2Payload kind) {
    if (kind == Svo2Payload::zstd_grey) {
        return {picture.luma.begin(), picture.luma.end()};
    }
    std::string bytes;
    if (kind == Svo2Payload::zstd_yuyv) {
        const auto width = static_cast<std::size_t>(picture.width);
        for (std::size_t i = 0; i < picture.luma.size(); ++i) {
            const std::size_t chroma = i / width / 2 * (width / 2) + i % width / 2;
            bytes += {static_cast<char>(picture.luma[i]),
                      static_cast<char>((i % 2 == 0 ? picture.blue : picture.red)[chroma])};
        }
        return bytes;
    }
    const std::vector<std::uint8_t> rgb = svo2_rgb(picture);
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        bytes += {static_cast<char>(rgb[i + 2]), static_cast<char>(rgb[i + 1]), static_cast<char>(rgb[i])};
        if (kind == Svo2Payload::zstd_bgra) {
            bytes += '\xFF';
        }
    }
    return bytes;
}

std::string packed(const std::string& bytes) {
    std::string result(ZSTD_compressBound(bytes.size()), '\0');
    result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 1));
    return result;
}

std::string ciphertext(int number) {
    std::mt19937 random(static_cast<unsigned>(number));
    std::string bytes(5000, '\0');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(random()); });
    return bytes;
}

}  // namespace

bool can_write(Svo2Payload kind) {
    const char* name = encoder_name(kind);
    return name == nullptr || avcodec_find_encoder_by_name(name) != nullptr;
}

void Svo2PayloadWriter::CloseEncoder::operator()(AVCodecContext* encoder) const {
    avcodec_free_context(&encoder);
}

Svo2PayloadWriter::Svo2PayloadWriter(Svo2Payload kind, int width, int height, int key_distance)
    : kind_(kind), key_distance_(key_distance) {
    const char* name = encoder_name(kind);
    if (name == nullptr) {
        return;
    }
    av_log_set_level(AV_LOG_ERROR);
    const AVCodec* codec = avcodec_find_encoder_by_name(name);
    must(codec == nullptr ? -1 : 0, "find an encoder");
    encoder_.reset(capture::or_bad_alloc(avcodec_alloc_context3(codec)));
    encoder_->width = width;
    encoder_->height = height;
    encoder_->pix_fmt = pixels_of(kind);
    encoder_->time_base = {1, 30};
    encoder_->gop_size = key_distance;
    set_up(*encoder_, kind);
    must(avcodec_open2(encoder_.get(), codec, nullptr), "open an encoder");
}

Svo2PayloadWriter::~Svo2PayloadWriter() = default;

Svo2PayloadWriter::Payload Svo2PayloadWriter::next(const Svo2Picture& picture) {
    Payload payload;
    if (encoder_ != nullptr) {
        payload = encoded(picture);
    } else {
        payload = {kind_ == Svo2Payload::encrypted ? ciphertext(frames_) : packed(raw(picture, kind_)), true};
    }
    ++frames_;
    return payload;
}

Svo2PayloadWriter::Payload Svo2PayloadWriter::encoded(const Svo2Picture& picture) {
    const FramePtr frame = frame_of(picture, encoder_->pix_fmt);
    frame->pts = frames_;
    frame->pict_type = frames_ % key_distance_ == 0 ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
    must(avcodec_send_frame(encoder_.get(), frame.get()), "encode a frame");
    const PacketPtr packet(capture::or_bad_alloc(av_packet_alloc()));
    must(avcodec_receive_packet(encoder_.get(), packet.get()), "give a packet for each frame");
    return {{reinterpret_cast<const char*>(packet->data), static_cast<std::size_t>(packet->size)},
            (packet->flags & AV_PKT_FLAG_KEY) != 0};
}

}  // namespace disparityd::test
