// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_format.h"

#include <algorithm>
#include <array>

namespace disparityd::capture {

namespace {

constexpr std::array<CameraFormat, 9> formats{
    {{"yuyv", fourcc_of("YUYV"), 2, Packing::plain, PixelFormat::yuyv},
     {"grey", fourcc_of("GREY"), 1, Packing::plain, PixelFormat::grey8},
     {"mjpeg", fourcc_of("MJPG"), 0, Packing::jpeg, PixelFormat::yuyv},
     {"y8i", fourcc_of("Y8I"), 2, Packing::y8i, PixelFormat::grey8},
     {"y12i", fourcc_of("Y12I"), 3, Packing::y12i, PixelFormat::grey8},
     {"bggr8", fourcc_of("BA81"), 1, Packing::bayer, PixelFormat::bgr24, 0, 0},
     {"gbrg8", fourcc_of("GBRG"), 1, Packing::bayer, PixelFormat::bgr24, 0, 1},
     {"grbg8", fourcc_of("GRBG"), 1, Packing::bayer, PixelFormat::bgr24, 1, 0},
     {"rggb8", fourcc_of("RGGB"), 1, Packing::bayer, PixelFormat::bgr24, 1, 1}}};

}  // namespace

const CameraFormat* camera_format_of_name(std::string_view name) {
    const auto found = std::find_if(formats.begin(), formats.end(),
                                    [name](const CameraFormat& format) { return format.name == name; });
    return found == formats.end() ? nullptr : &*found;
}

const CameraFormat* camera_format_of_fourcc(std::uint32_t fourcc) {
    const auto found = std::find_if(formats.begin(), formats.end(),
                                    [fourcc](const CameraFormat& format) { return format.fourcc == fourcc; });
    return found == formats.end() ? nullptr : &*found;
}

std::string camera_format_names() {
    std::string names;
    for (const CameraFormat& format : formats) {
        names += names.empty() ? "" : &format == &formats.back() ? " or " : ", ";
        names += format.name;
    }
    return names;
}

}  // namespace disparityd::capture
