// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_picture.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include "base/message_text.h"
#include "capture/recording/recording_format.h"
#include "capture/yuyv_rows.h"

namespace disparityd::capture {
namespace {

constexpr const char* taken =
    "video/x-raw, format = (string) { YUY2, UYVY, Y42B, I420, YV12, NV12, NV21, Y444, GRAY8, BGR, RGB, BGRx, RGBx, "
    "BGRA, RGBA }";

PixelFormat format_of(GstVideoFormat format) {
    switch (format) {
        case GST_VIDEO_FORMAT_YUY2:
        case GST_VIDEO_FORMAT_UYVY:
        case GST_VIDEO_FORMAT_Y42B: return PixelFormat::yuyv;
        case GST_VIDEO_FORMAT_BGR:
        case GST_VIDEO_FORMAT_RGB:
        case GST_VIDEO_FORMAT_BGRx:
        case GST_VIDEO_FORMAT_RGBx:
        case GST_VIDEO_FORMAT_BGRA:
        case GST_VIDEO_FORMAT_RGBA: return PixelFormat::bgr24;
        default: return PixelFormat::grey8;
    }
}

/// A frame in memory that can be read, as long as the object lives.
class MappedFrame {
public:
    MappedFrame(const GstVideoInfo& info, GstBuffer* buffer)
        : mapped_(gst_video_frame_map(&frame_, &info, buffer, GST_MAP_READ) != FALSE) {}
    ~MappedFrame() {
        if (mapped_) {
            gst_video_frame_unmap(&frame_);
        }
    }
    MappedFrame(const MappedFrame&) = delete;
    MappedFrame& operator=(const MappedFrame&) = delete;

    bool mapped() const { return mapped_; }
    /// A row of a component, which begins at its first sample.
    const std::uint8_t* row(guint component, int y) const {
        return static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame_, component)) +
               static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_COMP_STRIDE(&frame_, component);
    }
    /// A row of the first plane, from its first byte.
    std::uint8_t* plane_row(int y) const {
        return static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame_, 0)) +
               static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame_, 0);
    }
    std::size_t stride() const { return static_cast<std::size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame_, 0)); }

private:
    GstVideoFrame frame_{};
    bool mapped_;
};

void swap_pairs(const std::uint8_t* from, std::size_t bytes, std::uint8_t* to) {
    for (std::size_t i = 0; i < bytes; i += 2) {
        to[i] = from[i + 1];
        to[i + 1] = from[i];
    }
}

void convert_colours(const MappedFrame& frame, const GstPicture& picture, int channels, int conversion,
                     std::uint8_t* to) {
    const cv::Mat from(picture.height, picture.width, CV_8UC(channels), frame.plane_row(0), frame.stride());
    cv::Mat into(picture.height, picture.width, CV_8UC3, to);
    cv::cvtColor(from, into, conversion);
}

}  // namespace

GstPtr<GstCaps> taken_caps() {
    return GstPtr<GstCaps>(gst_caps_from_string(taken));
}

GstConverter::GstConverter(const GstCaps& caps, Holds holds) {
    if (gst_video_info_from_caps(&info_, &caps) == FALSE) {
        throw std::invalid_argument("found " + caps_text(&caps) + ", expected " + taken_formats +
                                    ": put videoconvert in front of the appsink");
    }
    picture_.format = format_of(GST_VIDEO_INFO_FORMAT(&info_));
    picture_.width = GST_VIDEO_INFO_WIDTH(&info_);
    picture_.height = GST_VIDEO_INFO_HEIGHT(&info_);
    if (GST_VIDEO_INFO_FPS_N(&info_) > 0 && GST_VIDEO_INFO_FPS_D(&info_) > 0) {
        picture_.rate = recording::plausible_rate(static_cast<double>(GST_VIDEO_INFO_FPS_N(&info_)) /
                                                  static_cast<double>(GST_VIDEO_INFO_FPS_D(&info_)));
    }
    check_layout(holds);
}

void GstConverter::check_layout(Holds holds) const {
    const std::string size = base::size_text(picture_.width, picture_.height);
    const bool both = holds == Holds::both_eyes;
    const int pixels_of_format = picture_.format == PixelFormat::yuyv ? 2 : 1;
    if (GST_VIDEO_INFO_INTERLACE_MODE(&info_) != GST_VIDEO_INTERLACE_MODE_PROGRESSIVE) {
        throw std::invalid_argument("its pictures are interlaced: put deinterlace in front of the appsink");
    }
    if (picture_.width > recording::max_side || picture_.height > recording::max_side ||
        std::int64_t{picture_.width} * picture_.height * (both ? 1 : 2) > recording::max_pixels) {
        throw std::invalid_argument("found pictures of " + size + ", which is too large");
    }
    if (picture_.width % (both ? 2 * pixels_of_format : pixels_of_format) != 0) {
        throw std::invalid_argument("found pictures of " + size + ", whose width has no two equal halves");
    }
    const GstVideoMultiviewMode mode = GST_VIDEO_INFO_MULTIVIEW_MODE(&info_);
    const bool plain = mode == GST_VIDEO_MULTIVIEW_MODE_NONE || mode == GST_VIDEO_MULTIVIEW_MODE_MONO;
    const GstVideoMultiviewMode expected = both                       ? GST_VIDEO_MULTIVIEW_MODE_SIDE_BY_SIDE
                                           : holds == Holds::left_eye ? GST_VIDEO_MULTIVIEW_MODE_LEFT
                                                                      : GST_VIDEO_MULTIVIEW_MODE_RIGHT;
    const bool flags = GST_VIDEO_INFO_MULTIVIEW_FLAGS(&info_) != GST_VIDEO_MULTIVIEW_FLAGS_NONE;
    const bool declared = mode == expected;
    if ((!plain && !declared) || flags) {
        const gchar* const name = gst_video_multiview_mode_to_caps_string(mode);
        throw std::invalid_argument(std::string("it declares the stereo layout \"") +
                                    (name != nullptr ? name : "none") + (flags ? "\" with multiview-flags" : "\"") +
                                    ", expected no flags and " +
                                    (both ? "side by side, the left eye in the left half"
                                          : std::string("the eye of its appsink, \"") +
                                                gst_video_multiview_mode_to_caps_string(expected) + "\""));
    }
    if (both && !declared && picture_.width / 2 < picture_.height) {
        throw std::invalid_argument("found pictures of " + size +
                                    ", which are those of one eye; expected both eyes side by side, or two appsinks, "
                                    "name=left and name=right");
    }
}

bool GstConverter::convert(GstBuffer* buffer, std::uint8_t* to) const {
    const MappedFrame frame(info_, buffer);
    if (!frame.mapped()) {
        return false;
    }
    switch (GST_VIDEO_INFO_FORMAT(&info_)) {
        case GST_VIDEO_FORMAT_RGB: convert_colours(frame, picture_, 3, cv::COLOR_RGB2BGR, to); return true;
        case GST_VIDEO_FORMAT_BGRx:
        case GST_VIDEO_FORMAT_BGRA: convert_colours(frame, picture_, 4, cv::COLOR_BGRA2BGR, to); return true;
        case GST_VIDEO_FORMAT_RGBx:
        case GST_VIDEO_FORMAT_RGBA: convert_colours(frame, picture_, 4, cv::COLOR_RGBA2BGR, to); return true;
        default: break;
    }
    const std::size_t row = picture_.row_bytes();
    for (int y = 0; y < picture_.height; ++y, to += row) {
        switch (GST_VIDEO_INFO_FORMAT(&info_)) {
            case GST_VIDEO_FORMAT_UYVY: swap_pairs(frame.plane_row(y), row, to); break;
            case GST_VIDEO_FORMAT_Y42B:
                pack_yuyv(frame.row(0, y), frame.row(1, y), frame.row(2, y), picture_.width / 2, to);
                break;
            default: std::memcpy(to, frame.plane_row(y), row); break;  // luma alone, YUY2 or BGR
        }
    }
    return true;
}

}  // namespace disparityd::capture
