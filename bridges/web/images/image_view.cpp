// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/image_view.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace disparityd::web {
namespace {

constexpr std::array<std::pair<Image, std::string_view>, 5> names{{{Image::left, "left"},
                                                                   {Image::disparity, "disparity"},
                                                                   {Image::depth, "depth"},
                                                                   {Image::confidence, "confidence"},
                                                                   {Image::depth_error, "depth_error"}}};

}  // namespace

std::string_view to_string(Image image) {
    return names[static_cast<std::size_t>(image)].second;
}

std::optional<Image> image_of(std::string_view name) {
    for (const auto& [image, word] : names) {
        if (word == name) {
            return image;
        }
    }
    return std::nullopt;
}

int shared_width(int most) {
    const auto above = std::upper_bound(shared_widths.begin(), shared_widths.end(), most);
    return above == shared_widths.begin() ? shared_widths.front() : *std::prev(above);
}

disparity::Product product_of(Image image) {
    switch (image) {
        case Image::left: return disparity::Product::left;
        case Image::confidence: return disparity::Product::confidence;
        case Image::depth_error: return disparity::Product::depth_error;
        case Image::disparity:
        case Image::depth: break;
    }
    return disparity::Product::disparity;
}

}  // namespace disparityd::web
