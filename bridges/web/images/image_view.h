// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "clients/cpp/disparity_client.hpp"
#include "proto/products.h"

namespace disparityd::web {

/// An image of a frame that a page can ask for: a product that is seen and is not the same in colour as another one.
using Image = disparity::Product;

/// Returns the row of the table of products.
const proto::ProductFacts& facts_of(Image image);

/// Returns the image of this name, or nothing.
std::optional<Image> image_of(std::string_view name);

/// Returns the names of all images, for messages: "disparity, confidence, ...".
std::string image_names();

/// Returns the product that the image is made from. Depth is computed from the disparity: it needs no product of its
/// own.
disparity::Product product_of(Image image);

/// Returns the products of which the image is made where the daemon makes them: that of product_of(), and the one that
/// is the same in colour.
std::set<disparity::Product> products_of(Image image);

/// Returns the plane that shows the image, in colour where the frame carries that; nullptr where it carries none.
const disparity::PlaneData* shown_plane(const disparity::Frame& frame, Image image);

/// How the pixels travel.
enum class Encoding {
    jpeg,     ///< what people look at: disparity and depth are coloured
    deflate,  ///< the values themselves, little endian rows without gaps, in zlib's format
};

/// Distances (m) that get the last and the first colour.
struct RangeM {
    double near = 0;
    double far = 0;
    auto operator<=>(const RangeM&) const = default;
};

/// Widths (px) in which JPEGs are made when less than the whole width is asked for. They are few, so that connections
/// share what is encoded.
inline constexpr std::array<int, 12> shared_widths{16, 40, 80, 160, 320, 480, 640, 960, 1280, 1920, 2560, 3840};

/// Returns the largest of shared_widths that is at most this; the smallest where there is none.
int shared_width(int most);

/// Says what is made of a frame. Equal views of a frame are encoded once.
struct ImageView {
    Image image = Image::left;
    Encoding encoding = Encoding::jpeg;
    int max_width = 0;            ///< px; 0 = as it is, else taken down to one of shared_widths. Only JPEG is scaled
    int quality = 80;             ///< of a JPEG, 1 .. 100
    std::optional<RangeM> range;  ///< absent = what the searched disparities can show
    auto operator<=>(const ImageView&) const = default;
};

/// An image ready to be sent.
struct EncodedImage {
    Image image = Image::left;
    Encoding encoding = Encoding::jpeg;
    std::string type;              ///< of a value: ProductFacts::type, or "bgr8"; of a JPEG "u8" or "bgr8"
    int width = 0;                 ///< px
    int height = 0;                ///< px
    double low = 0;                ///< the value with the first colour, in the unit of the image
    double high = 0;               ///< the value with the last colour
    std::optional<double> near_m;  ///< the distance of the nearer end of the colours; absent = has no meaning
    std::optional<double> far_m;   ///< absent = infinity, or no meaning
    std::shared_ptr<const std::string> bytes;
};

}  // namespace disparityd::web
