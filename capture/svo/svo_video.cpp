// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/svo_video.h"

#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

#include "base/message_text.h"
#include "capture/pixel_format.h"
#include "capture/recording/recording_format.h"

namespace disparityd::capture {

SvoVideo::SvoVideo(AnnexBCodec codec, const std::string& path)
    : packet_(or_bad_alloc(av_packet_alloc())), frame_(or_bad_alloc(av_frame_alloc())) {
    keep_ffmpeg_log();
    const AVCodecID id = codec == AnnexBCodec::h264 ? AV_CODEC_ID_H264 : AV_CODEC_ID_HEVC;
    const AVCodec* found = avcodec_find_decoder(id);
    if (found == nullptr) {
        throw std::invalid_argument(path + ": this FFmpeg has no decoder for " + avcodec_get_name(id));
    }
    decoder_.reset(or_bad_alloc(avcodec_alloc_context3(found)));
    decoder_->max_pixels = recording::max_pixels;
    decoder_->thread_count = 1;  // the source decodes ahead already; the cores belong to the matcher
    decoder_->pkt_timebase = {1, 1};
    clear_ffmpeg_log();
    if (const int result = avcodec_open2(decoder_.get(), found, nullptr); result < 0) {
        throw std::invalid_argument(path + ": cannot decode " + avcodec_get_name(id) + ": " + ffmpeg_reason(result));
    }
}

void SvoVideo::send(std::span<const std::uint8_t> unit, std::int64_t number) {
    av_packet_unref(packet_.get());
    if (av_new_packet(packet_.get(), static_cast<int>(unit.size())) < 0) {
        throw std::bad_alloc();
    }
    std::memcpy(packet_->data, unit.data(), unit.size());
    packet_->pts = number;
    packet_->dts = number;
    clear_ffmpeg_log();
    const int result = avcodec_send_packet(decoder_.get(), packet_.get());
    av_packet_unref(packet_.get());
    if (result < 0) {
        throw std::runtime_error(ffmpeg_reason(result));
    }
}

void SvoVideo::end() {
    avcodec_send_packet(decoder_.get(), nullptr);
}

std::optional<SvoVideo::Decoded> SvoVideo::receive() {
    clear_ffmpeg_log();
    const int result = avcodec_receive_frame(decoder_.get(), frame_.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) {
        return std::nullopt;
    }
    if (result < 0) {
        throw std::runtime_error(ffmpeg_reason(result));
    }
    open_loader();
    Decoded decoded;
    decoded.number = frame_->pts;
    SvoPicture& picture = decoded.picture;
    picture.format = loader_->format();
    picture.width = frame_->width;
    picture.height = frame_->height;
    picture.damaged = (frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0;
    picture.pixels.create(picture.height, picture.width, CV_8UC(bytes_per_pixel(picture.format)));
    loader_->load(*frame_, picture.pixels.data);
    av_frame_unref(frame_.get());
    return decoded;
}

/// Prepares for the pictures that come, which may be others than before: the stream says their size.
void SvoVideo::open_loader() {
    const int width = frame_->width;
    const int height = frame_->height;
    if (loader_ && loader_size_.width == width && loader_size_.height == height && loader_format_ == frame_->format) {
        return;
    }
    loader_.reset();
    if (width < 2 || height < 1 || width % 2 != 0 || width / 2 < height) {
        throw std::runtime_error("its picture of " + base::size_text(width, height) +
                                 " does not hold two eyes side by side");
    }
    auto loader = std::make_unique<PixelLoader>(static_cast<AVPixelFormat>(frame_->format), width, height);
    if (loader->format() == PixelFormat::yuyv && width % 4 != 0) {
        throw std::runtime_error("its YUV 4:2:2 picture of " + base::size_text(width, height) +
                                 " does not hold two eyes of even width");
    }
    loader_ = std::move(loader);
    loader_size_ = {width, height};
    loader_format_ = frame_->format;
}

}  // namespace disparityd::capture
