// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/video_reader.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <algorithm>
#include <new>
#include <stdexcept>
#include <utility>

#include "base/words.h"
#include "capture/pixel_format.h"

namespace disparityd::capture {

VideoReader::VideoReader(RecordingInput input, int track) : input_(std::move(input)), stream_(track) {
    input_.choose_video(stream_);
    packet_.reset(or_bad_alloc(av_packet_alloc()));
    frame_.reset(or_bad_alloc(av_frame_alloc()));
    info_.height = stream().codecpar->height;
    info_.eye_width = stream().codecpar->width / 2;
    info_.content = std::string(avcodec_get_name(stream().codecpar->codec_id)) + " video";
}

std::size_t VideoReader::frame_bytes() const {
    return 2 * static_cast<std::size_t>(info_.eye_width) * static_cast<std::size_t>(info_.height) *
           static_cast<std::size_t>(bytes_per_pixel(info_.format));
}

void VideoReader::open_decoder(AVPixelFormat stored) {
    const std::string& path = input_.path();
    const AVCodecParameters& parameters = *stream().codecpar;
    const AVCodec* codec = avcodec_find_decoder(parameters.codec_id);
    if (codec == nullptr) {
        throw std::invalid_argument(path + ": this FFmpeg has no decoder for " + avcodec_get_name(parameters.codec_id));
    }
    decoder_.reset(or_bad_alloc(avcodec_alloc_context3(codec)));
    if (avcodec_parameters_to_context(decoder_.get(), &parameters) < 0) {
        throw std::bad_alloc();
    }
    decoder_->pkt_timebase = stream().time_base;
    decoder_->max_pixels = recording::max_pixels;
    decoder_->thread_count = 1;  // the source decodes ahead already; the cores belong to the matcher
    clear_ffmpeg_log();
    if (const int result = avcodec_open2(decoder_.get(), codec, nullptr); result < 0) {
        throw std::invalid_argument(path + ": cannot decode " + avcodec_get_name(parameters.codec_id) + ": " +
                                    ffmpeg_reason(result));
    }
    check_limits();
    try {
        loader_ = std::make_unique<PixelLoader>(stored, parameters.width, parameters.height);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(path + ": cannot be used as frames: " + error.what());
    }
    stored_ = stored;
    info_.format = loader_->format();
    check_size();
}

void VideoReader::open_jpegs(const EyeLayout& layout) {
    check_limits();
    info_.format = PixelFormat::yuyv;
    info_.eye_width = layout.eye_width;
    info_.height = layout.eye_height;
    if (layout.frame_width() != stream().codecpar->width || layout.frame_height() != stream().codecpar->height ||
        layout.eye_width % 2 != 0) {
        throw std::invalid_argument(input_.path() + ": found JPEGs of " + std::to_string(stream().codecpar->width) +
                                    " x " + std::to_string(stream().codecpar->height) +
                                    ", expected two eyes of even width");
    }
    jpegs_ = std::make_unique<JpegDecoder>(layout);
}

void VideoReader::check_limits() const {
    const int width = stream().codecpar->width;
    const int height = stream().codecpar->height;
    if (width < 1 || height < 1 || width > recording::max_side || height > recording::max_side ||
        std::int64_t{width} * height > recording::max_pixels) {
        throw std::invalid_argument(input_.path() + ": found a picture of " + std::to_string(width) + " x " +
                                    std::to_string(height) + ", allowed up to " + std::to_string(recording::max_side) +
                                    " each way and " + std::to_string(recording::max_pixels) + " pixels");
    }
}

void VideoReader::check_size() const {
    const int width = stream().codecpar->width;
    if (width % 2 != 0) {
        throw std::invalid_argument(input_.path() + ": found a picture " + std::to_string(width) +
                                    " pixels wide, expected two eyes side by side: an even width");
    }
    if (info_.format == PixelFormat::yuyv && width % 4 != 0) {
        throw std::invalid_argument(input_.path() + ": found a YUV 4:2:2 picture " + std::to_string(width) +
                                    " pixels wide, expected two eyes of even width side by side: a multiple of 4");
    }
}

bool VideoReader::read(recording::FrameFacts& facts, std::uint8_t* pixels) {
    if (ended_) {
        return false;
    }
    ended_ = true;  // unless a whole frame comes out: errors end the video, too
    const RawImage image{pixels, info_.format, info_.eye_width, info_.height,
                         std::ptrdiff_t{2} * info_.eye_width * bytes_per_pixel(info_.format)};
    do {
        if (!(jpegs_ ? next_jpeg(facts, pixels) : next_picture(facts, pixels))) {
            check_end();
            return false;
        }
    } while (!keep(facts, image));
    ++frames_;
    ended_ = false;
    return true;
}

bool VideoReader::next_picture(recording::FrameFacts& facts, std::uint8_t* pixels) {
    while (!receive_frame()) {
        if (draining_) {
            return false;
        }
        send_packet();
    }
    check_picture();
    facts = take_facts(*frame_);
    loader_->load(*frame_, pixels);
    av_frame_unref(frame_.get());
    return true;
}

bool VideoReader::next_jpeg(recording::FrameFacts& facts, std::uint8_t* pixels) {
    while (read_packet()) {
        if (!accept(*packet_)) {
            continue;
        }
        const char* problem = jpegs_->decode({packet_->data, static_cast<std::size_t>(packet_->size)}, pixels);
        if (problem == nullptr) {
            facts = take_facts(*frame_);
            return true;
        }
        refused(problem);
    }
    return false;
}

bool VideoReader::receive_frame() {
    clear_ffmpeg_log();
    const int result = avcodec_receive_frame(decoder_.get(), frame_.get());
    if (result >= 0) {
        return true;
    }
    if (result != AVERROR(EAGAIN) && result != AVERROR_EOF) {
        refused(ffmpeg_reason(result));
    }
    return false;
}

bool VideoReader::read_packet() {
    int result = 0;
    do {
        av_packet_unref(packet_.get());
        clear_ffmpeg_log();
        result = av_read_frame(&input_.context(), packet_.get());
    } while (result >= 0 && packet_->stream_index != stream_);
    end_error_ = std::min(result, 0);
    return result >= 0;
}

/// Gives the decoder the next packet, or tells it that there are no more.
void VideoReader::send_packet() {
    if (!read_packet()) {
        draining_ = true;
        avcodec_send_packet(decoder_.get(), nullptr);
        return;
    }
    if (!accept(*packet_)) {
        av_packet_unref(packet_.get());
        return;
    }
    clear_ffmpeg_log();
    const int result = avcodec_send_packet(decoder_.get(), packet_.get());
    av_packet_unref(packet_.get());
    if (result < 0) {
        refused(ffmpeg_reason(result));
    }
}

void VideoReader::check_picture() const {
    const AVCodecParameters& expected = *stream().codecpar;
    if (frame_->width != expected.width || frame_->height != expected.height || frame_->format != stored_) {
        fail_changed_picture(*frame_);
    }
}

void VideoReader::check_file_size() const {
    if (const auto missing = input_.missing_bytes()) {
        fail_truncated("the file was cut: " + *missing);
    }
}

void VideoReader::check_end_error() const {
    if (end_error_ != AVERROR_EOF) {
        fail_damaged(ffmpeg_reason(end_error_));
    }
}

void VideoReader::fail_truncated(const std::string& how) const {
    throw std::runtime_error(input_.path() + ": truncated: " + frames_read() + " could be read, " + how);
}

void VideoReader::fail_damaged(const std::string& how) const {
    throw std::runtime_error(input_.path() + ": damaged after " + frames_read() + ": " + how);
}

void VideoReader::fail_changed_picture(const AVFrame& frame) const {
    const auto text = [](int width, int height, int pixels) {
        const char* pixel_name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(pixels));
        return std::to_string(width) + " x " + std::to_string(height) + " " +
               (pixel_name == nullptr ? "unknown" : pixel_name);
    };
    const AVCodecParameters& expected = *stream().codecpar;
    throw std::runtime_error(input_.path() + ": the picture changes after " + frames_read() + ": found " +
                             text(frame.width, frame.height, frame.format) + ", the video began with " +
                             text(expected.width, expected.height, stored_));
}

std::string VideoReader::frames_read() const {
    if (info_.frame_count) {
        return std::to_string(frames_) + " of " + base::counted(*info_.frame_count, "frame");
    }
    return base::counted(frames_, "frame");
}

}  // namespace disparityd::capture
