// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/image_encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <zlib.h>

#include "bridges/frames/planes.h"
#include "bridges/web/images/colours.h"
#include "clients/cpp/nearest_pixel.h"
#include "formats/pictures/jpeg_writer.h"

namespace disparityd::web {
namespace {

using disparity::PlaneData;
using disparity::Product;
using formats::jpeg_of;
using frames::depth_mm;
using frames::has_metres;
using frames::value_at;

std::string deflated(const void* data, std::size_t bytes) {
    uLongf size = compressBound(bytes);
    std::string packed(size, '\0');
    constexpr int fastest = 1;
    if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, static_cast<const Bytef*>(data), bytes, fastest) !=
        Z_OK) {
        throw std::runtime_error("an image cannot be compressed: no memory");
    }
    packed.resize(size);
    return packed;
}

cv::Size scaled_size(const PlaneData& plane, int max_width) {
    const int width = static_cast<int>(plane.width);
    const int height = static_cast<int>(plane.height);
    if (max_width <= 0 || width <= max_width) {
        return {width, height};
    }
    return {max_width, std::max(1, (height * max_width + width / 2) / width)};
}

/// Returns the plane as it is seen, without a copy.
cv::Mat mat_of(const PlaneData& plane, int type) {
    return {static_cast<int>(plane.height), static_cast<int>(plane.width), type,
            const_cast<std::uint8_t*>(plane.bytes.data())};
}

/// Pixels of the camera: means of what falls together.
cv::Mat scaled_picture(const PlaneData& plane, int max_width) {
    const cv::Mat whole = mat_of(plane, plane.bytes_per_pixel == 3 ? CV_8UC3 : CV_8UC1);
    const cv::Size size = scaled_size(plane, max_width);
    if (size == whole.size()) {
        return whole;
    }
    cv::Mat smaller;
    cv::resize(whole, smaller, size, 0, 0, cv::INTER_AREA);
    return smaller;
}

/// Colours of measured values: one pixel of those that fall together, since a mean of two distances is none of them.
template <typename T, typename ColourOf>
cv::Mat coloured(const PlaneData& plane, int max_width, const ColourOf& colour_of) {
    const cv::Size size = scaled_size(plane, max_width);
    cv::Mat picture(size, CV_8UC3);
    std::vector<std::size_t> column(static_cast<std::size_t>(size.width));
    for (std::size_t x = 0; x < column.size(); ++x) {
        column[x] = x * plane.width / column.size();
    }
    for (int y = 0; y < size.height; ++y) {
        const std::size_t from = static_cast<std::size_t>(y) * plane.height / static_cast<std::size_t>(size.height);
        const std::uint8_t* const row = plane.bytes.data() + from * plane.width * sizeof(T);
        auto* to = picture.ptr<std::uint8_t>(y);
        for (const std::size_t x : column) {
            T value;
            std::memcpy(&value, row + x * sizeof(T), sizeof(T));
            const Colour& colour = colour_of(value);
            to = std::copy(colour.begin(), colour.end(), to);
        }
    }
    return picture;
}

/// Sets which values have the first and the last colour. Returns the colours of disparities, for images that have them.
std::optional<DisparityColours> set_range(const disparity::Frame& frame, const ImageView& view, EncodedImage& made) {
    if (facts_of(view.image).view == v1::DISTANCE) {
        DisparityColours colours(frame, view.image, view.range);
        made.low = colours.low;
        made.high = colours.high;
        made.near_m = colours.near_m;
        made.far_m = colours.far_m;
        return colours;
    }
    const double shown_max = facts_of(view.image).shown_max;
    made.high = shown_max > 0 ? shown_max : 255;
    return std::nullopt;
}

cv::Mat draw(const PlaneData& plane, const ImageView& view, const std::optional<DisparityColours>& colours) {
    if (colours) {
        return coloured<std::int16_t>(plane, view.max_width,
                                      [&](std::int16_t d16) -> const Colour& { return colours->of(d16); });
    }
    if (facts_of(view.image).view == v1::SPREAD) {
        static constexpr Colour unknown{0, 0, 0};
        const double scale = 255.0 / facts_of(view.image).shown_max;
        return coloured<std::uint16_t>(plane, view.max_width, [scale](std::uint16_t value) -> const Colour& {
            return value == 0 ? unknown : turbo()[static_cast<std::size_t>(std::min(255.0, scale * value))];
        });
    }
    return scaled_picture(plane, view.max_width);
}

/// The values as they are. Depth is computed here: the daemon need not make it.
std::string values_of(const disparity::Frame& frame, const PlaneData& plane, const ImageView& view) {
    if (view.image != Image::depth) {
        return deflated(plane.bytes.data(), plane.bytes.size());
    }
    std::vector<std::uint16_t> depth(static_cast<std::size_t>(plane.width) * plane.height);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        std::int16_t d16;
        std::memcpy(&d16, plane.bytes.data() + 2 * i, sizeof d16);
        depth[i] = depth_mm(frame, d16);
    }
    return deflated(depth.data(), 2 * depth.size());
}

std::string type_of(const PlaneData& plane, Image image) {
    return plane.bytes_per_pixel == 3 ? "bgr8" : std::string(facts_of(image).type);
}

/// Returns the view that is made instead of the one that is asked for, so that many connections share few views: the
/// thread that encodes is one for all.
ImageView shared_view(const LiveFrame& live, ImageView view, int whole_width) {
    if (view.encoding == Encoding::deflate) {
        view.max_width = 0;
        view.quality = 0;
        return view;  // a range costs nothing: the values are the same
    }
    view.max_width = view.max_width <= 0 || view.max_width >= whole_width ? 0 : shared_width(view.max_width);
    if (view.range) {
        std::set<RangeM> ranges;
        for (const auto& [made, image] : live.encoded) {
            if (made.range && made.encoding == Encoding::jpeg) {
                ranges.insert(*made.range);
            }
        }
        if (ranges.size() >= most_ranges && ranges.count(*view.range) == 0) {
            view.range.reset();
        }
    }
    return view;
}

/// Returns the values of an image when they were made before, for whatever range; else nullptr.
std::shared_ptr<const std::string> values_made(const LiveFrame& live, Image image) {
    const auto found = std::find_if(live.encoded.begin(), live.encoded.end(), [image](const auto& entry) {
        return entry.first.image == image && entry.first.encoding == Encoding::deflate;
    });
    return found != live.encoded.end() ? found->second->bytes : nullptr;
}

int shared_step(int step) {
    int shared = 1;
    while (shared < step) {
        shared *= 2;
    }
    return shared;
}

std::shared_ptr<const DepthGrid> make_grid(const disparity::Frame& frame, const PlaneData& plane, int step) {
    auto grid = std::make_shared<DepthGrid>();
    const auto stride = static_cast<std::uint32_t>(step);
    grid->step = step;
    grid->width = static_cast<int>((plane.width + stride - 1) / stride);
    grid->height = static_cast<int>((plane.height + stride - 1) / stride);
    std::vector<std::uint16_t> depth;
    depth.reserve(static_cast<std::size_t>(grid->width) * static_cast<std::size_t>(grid->height));
    const auto at = [&plane](std::size_t pixel) {
        return value_at<std::int16_t>(plane, static_cast<std::uint32_t>(pixel % plane.width),
                                      static_cast<std::uint32_t>(pixel / plane.width));
    };
    // The greater the disparity the nearer, which spares a division for each pixel.
    const std::int64_t offset16 = std::llround(16 * frame.disparity_offset);
    const auto distance = [&](std::size_t pixel) {
        const std::int16_t disparity = at(pixel);
        const bool known = disparity != frame.invalid && disparity + offset16 > 0;
        return known ? -static_cast<float>(disparity) : std::numeric_limits<float>::quiet_NaN();
    };
    disparity::for_each_nearest(plane.width, plane.height, stride, distance,
                                [&](std::size_t pixel) { depth.push_back(depth_mm(frame, at(pixel))); });
    grid->bytes = std::make_shared<const std::string>(deflated(depth.data(), 2 * depth.size()));
    return grid;
}

}  // namespace

std::shared_ptr<const EncodedImage> encode(const LiveFrame& live, const ImageView& asked) {
    const PlaneData* const plane = shown_plane(live.frame, asked.image);
    if (plane == nullptr) {
        return nullptr;
    }
    const ImageView view = shared_view(live, asked, static_cast<int>(plane->width));
    if (const auto found = live.encoded.find(view); found != live.encoded.end()) {
        return found->second;
    }
    auto made = std::make_shared<EncodedImage>();
    made->image = view.image;
    made->encoding = view.encoding;
    const auto colours = set_range(live.frame, view, *made);
    if (view.encoding == Encoding::jpeg) {
        const cv::Mat picture = draw(*plane, view, colours);
        made->width = picture.cols;
        made->height = picture.rows;
        made->type = picture.channels() == 3 ? "bgr8" : "u8";
        made->bytes = std::make_shared<const std::string>(
            jpeg_of({picture.data, picture.cols, picture.rows, static_cast<int>(picture.step), picture.channels() == 1},
                    view.quality));
    } else {
        made->width = static_cast<int>(plane->width);
        made->height = static_cast<int>(plane->height);
        made->type = type_of(*plane, view.image);
        made->bytes = values_made(live, view.image);
        if (made->bytes == nullptr) {
            made->bytes = std::make_shared<const std::string>(values_of(live.frame, *plane, view));
        }
    }
    live.encoded.emplace(view, made);
    return made;
}

std::shared_ptr<const DepthGrid> depth_grid(const LiveFrame& live, int step) {
    const PlaneData* const plane = live.frame.plane(Product::disparity);
    if (plane == nullptr || step < 1 || !has_metres(live.frame)) {
        return nullptr;
    }
    std::shared_ptr<const DepthGrid>& grid = live.grids[shared_step(step)];
    if (grid == nullptr) {
        grid = make_grid(live.frame, *plane, shared_step(step));
    }
    return grid;
}

}  // namespace disparityd::web
