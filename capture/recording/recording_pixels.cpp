// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_pixels.h"

extern "C" {
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <cstring>
#include <stdexcept>
#include <string>

#include "capture/yuyv_rows.h"

namespace disparityd::capture {
namespace {

std::uint8_t* plane_row(const AVFrame& frame, int plane, int y) {
    return frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane];
}

void unpack_422(const std::uint8_t* from, int pairs, std::uint8_t* luma, std::uint8_t* u, std::uint8_t* v) {
    for (int i = 0; i < pairs; ++i) {
        luma[2 * i] = from[4 * i];
        u[i] = from[4 * i + 1];
        luma[2 * i + 1] = from[4 * i + 2];
        v[i] = from[4 * i + 3];
    }
}

bool luma_is_plain(const AVPixFmtDescriptor& format) {
    const AVComponentDescriptor& luma = format.comp[0];
    return (format.flags & (AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_PAL)) == 0 &&
           luma.depth == 8 && luma.step == 1 && luma.offset == 0 && luma.plane == 0;
}

}  // namespace

AVPixelFormat stored_format(PixelFormat format) {
    switch (format) {
        case PixelFormat::grey8: return AV_PIX_FMT_GRAY8;
        case PixelFormat::yuyv: return AV_PIX_FMT_YUV422P;
        case PixelFormat::bgr24: return AV_PIX_FMT_GBRP;
    }
    return AV_PIX_FMT_NONE;
}

void store_pixels(const RawImage& image, AVFrame& frame) {
    const int width = 2 * image.eye_width;
    for (int y = 0; y < image.height; ++y) {
        const std::uint8_t* from = image.data + y * image.stride;
        std::uint8_t* first = plane_row(frame, 0, y);
        switch (image.format) {
            case PixelFormat::grey8: std::memcpy(first, from, static_cast<std::size_t>(width)); break;
            case PixelFormat::yuyv:
                unpack_422(from, width / 2, first, plane_row(frame, 1, y), plane_row(frame, 2, y));
                break;
            case PixelFormat::bgr24: {
                std::uint8_t* blue = plane_row(frame, 1, y);
                std::uint8_t* red = plane_row(frame, 2, y);
                for (int x = 0; x < width; ++x) {
                    blue[x] = from[3 * x];
                    first[x] = from[3 * x + 1];
                    red[x] = from[3 * x + 2];
                }
                break;
            }
        }
    }
}

PixelLoader::PixelLoader(AVPixelFormat stored, int width, int height) : width_(width), height_(height) {
    const AVPixFmtDescriptor* description = av_pix_fmt_desc_get(stored);
    if (description == nullptr) {
        throw std::invalid_argument("the pixel format is not known");
    }
    const bool colour = (description->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) != 0;
    if (stored == AV_PIX_FMT_YUV422P || stored == AV_PIX_FMT_YUVJ422P) {
        way_ = Way::pack_422;
        format_ = PixelFormat::yuyv;
    } else if (stored == AV_PIX_FMT_YUYV422) {
        format_ = PixelFormat::yuyv;
    } else if (stored == AV_PIX_FMT_GBRP) {
        way_ = Way::interleave_gbr;
        format_ = PixelFormat::bgr24;
    } else if (stored == AV_PIX_FMT_BGR24) {
        format_ = PixelFormat::bgr24;
    } else if (colour || !luma_is_plain(*description)) {
        way_ = Way::scale;
        format_ = colour ? PixelFormat::bgr24 : PixelFormat::grey8;
        const AVPixelFormat to = colour ? AV_PIX_FMT_BGR24 : AV_PIX_FMT_GRAY8;
        scaler_.reset(sws_getContext(width, height, stored, width, height, to, SWS_POINT, nullptr, nullptr, nullptr));
        if (!scaler_) {
            throw std::invalid_argument(std::string("pixel format ") + description->name + " is not supported");
        }
        scaled_.reset(or_bad_alloc(av_frame_alloc()));
        scaled_->width = width;
        scaled_->height = height;
        scaled_->format = to;
        if (av_frame_get_buffer(scaled_.get(), 0) < 0) {
            throw std::bad_alloc();
        }
    }
}

void PixelLoader::FreeScaler::operator()(SwsContext* scaler) const {
    sws_freeContext(scaler);
}

void PixelLoader::copy_rows(const AVFrame& frame, std::uint8_t* to) const {
    const auto row = static_cast<std::size_t>(width_) * static_cast<std::size_t>(bytes_per_pixel(format_));
    for (int y = 0; y < height_; ++y) {
        std::memcpy(to + static_cast<std::size_t>(y) * row, plane_row(frame, 0, y), row);
    }
}

void PixelLoader::load(const AVFrame& frame, std::uint8_t* to) {
    if (way_ == Way::copy_rows) {
        copy_rows(frame, to);
        return;
    }
    if (way_ == Way::scale) {
        sws_scale(scaler_.get(), frame.data, frame.linesize, 0, height_, scaled_->data, scaled_->linesize);
        copy_rows(*scaled_, to);
        return;
    }
    const auto row = static_cast<std::ptrdiff_t>(width_) * bytes_per_pixel(format_);
    for (int y = 0; y < height_; ++y, to += row) {
        const std::uint8_t* first = plane_row(frame, 0, y);
        const std::uint8_t* second = plane_row(frame, 1, y);
        const std::uint8_t* third = plane_row(frame, 2, y);
        if (way_ == Way::pack_422) {
            pack_yuyv(first, second, third, width_ / 2, to);
            continue;
        }
        for (int x = 0; x < width_; ++x) {
            to[3 * x] = second[x];
            to[3 * x + 1] = first[x];
            to[3 * x + 2] = third[x];
        }
    }
}

}  // namespace disparityd::capture
