// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <gst/video/video.h>

#include "capture/gstreamer/gst_library.h"
#include "kernels/raw_image.h"

namespace disparityd::capture {

/// What the pictures are that an appsink gets.
struct GstPicture {
    PixelFormat format = PixelFormat::grey8;  ///< that they are converted to
    int width = 0;
    int height = 0;
    double rate = 0;  ///< frames per second; 0 = unknown

    std::size_t row_bytes() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(bytes_per_pixel(format));
    }
    std::size_t bytes() const { return row_bytes() * static_cast<std::size_t>(height); }
    bool operator==(const GstPicture&) const = default;
};

/// What an appsink is told to ask for.
GstPtr<GstCaps> taken_caps();

/// The formats of taken_caps(), for messages.
inline constexpr const char* taken_formats =
    "video/x-raw in ordinary memory, of the formats YUY2, UYVY, Y42B, I420, YV12, NV12, NV21, Y444, GRAY8, BGR, RGB, "
    "BGRx, RGBx, BGRA and RGBA";

/// Converts what has these caps: packed and planar 4:2:2 becomes yuyv, RGB becomes bgr24, of 4:2:0 and 4:4:4 the luma
/// is taken as grey8. One thread uses an object.
class GstConverter {
public:
    enum class Holds : std::uint8_t { both_eyes, left_eye, right_eye };

    /// Throws std::invalid_argument, with one line without the source's name, for what is not taken.
    GstConverter(const GstCaps& caps, Holds holds);

    const GstPicture& picture() const { return picture_; }

    /// Writes a picture to `to`, picture().bytes() long, rows without gaps. False: the buffer is too short.
    bool convert(GstBuffer* buffer, std::uint8_t* to) const;

private:
    void check_layout(Holds holds) const;

    GstVideoInfo info_{};
    GstPicture picture_;
};

}  // namespace disparityd::capture
