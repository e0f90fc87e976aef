// SPDX-License-Identifier: Apache-2.0
#include "capture/pixel_format.h"

#include <array>
#include <utility>

namespace disparityd::capture {
namespace {

constexpr std::array<std::pair<PixelFormat, std::string_view>, 3> pixel_format_names{{
    {PixelFormat::grey8, "grey8"},
    {PixelFormat::yuyv, "yuyv"},
    {PixelFormat::bgr24, "bgr24"},
}};

}  // namespace

std::string_view to_string(PixelFormat format) {
    for (const auto& [known, text] : pixel_format_names) {
        if (known == format) {
            return text;
        }
    }
    return "unknown";
}

std::optional<PixelFormat> pixel_format_from_name(std::string_view text) {
    for (const auto& [format, known] : pixel_format_names) {
        if (known == text) {
            return format;
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::capture
