// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/regions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>

#include "tools/eval/opencv_matcher.h"

namespace disparityd::eval {
namespace {

using Pixels = std::vector<std::uint8_t>;

/// Marks both pixels of each pair of neighbours whose disparities are far apart.
Pixels steps_of(const images::FloatMap& truth) {
    constexpr float gap = 2;
    const auto width = static_cast<std::size_t>(truth.width);
    Pixels steps(truth.values.size(), 0);
    const auto mark = [&](std::size_t one, std::size_t other) {
        const float a = truth.values[one];
        const float b = truth.values[other];
        if (std::isfinite(a) && std::isfinite(b) && std::abs(a - b) >= gap) {
            steps[one] = steps[other] = 1;
        }
    };
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        if ((i + 1) % width != 0) {
            mark(i, i + 1);
        }
        if (i + width < truth.values.size()) {
            mark(i, i + width);
        }
    }
    return steps;
}

/// Sums of a plane over windows of (2 * reach + 1)^2, of what lies in the plane.
class WindowSums {
public:
    template <typename Values>
    WindowSums(const Values& values, int width, int height)
        : width_(width),
          height_(height),
          sums_(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1)) {
        auto value = values.begin();
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x, ++value) {
                sums_[at(x + 1, y + 1)] =
                    std::int64_t{*value} + sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)];
            }
        }
    }

    /// The sum around a pixel, and of how many pixels it is.
    std::pair<std::int64_t, int> around(int x, int y, int reach) const {
        const int left = std::max(x - reach, 0), right = std::min(x + reach + 1, width_);
        const int top = std::max(y - reach, 0), bottom = std::min(y + reach + 1, height_);
        return {sums_[at(right, bottom)] - sums_[at(left, bottom)] - sums_[at(right, top)] + sums_[at(left, top)],
                (right - left) * (bottom - top)};
    }

private:
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(x);
    }

    int width_;
    int height_;
    std::vector<std::int64_t> sums_;
};

/// Marks the pixels around which a window holds a condition.
Pixels where(int width, int height, const WindowSums& sums, int reach,
             const std::function<bool(std::int64_t sum, int count)>& holds) {
    Pixels marked;
    marked.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto [sum, count] = sums.around(x, y, reach);
            marked.push_back(holds(sum, count) ? 1 : 0);
        }
    }
    return marked;
}

Pixels near_edges(const images::FloatMap& truth) {
    constexpr int reach = 4;
    return where(truth.width, truth.height, WindowSums(steps_of(truth), truth.width, truth.height), reach,
                 [](std::int64_t sum, int /*count*/) { return sum > 0; });
}

Pixels weakly_textured(const cv::Mat& image) {
    constexpr int reach = 1;
    constexpr int limit = 4 * 4;
    const cv::Mat luma = grey(image);
    std::vector<int> squares;
    squares.reserve(luma.total());
    for (int y = 0; y < luma.rows; ++y) {
        const auto* row = luma.ptr<std::uint8_t>(y);
        for (int x = 0; x < luma.cols; ++x) {
            const int to_left = row[x] - row[std::max(x - 1, 0)];
            const int to_right = row[x] - row[std::min(x + 1, luma.cols - 1)];
            squares.push_back(std::max(to_left * to_left, to_right * to_right));
        }
    }
    return where(luma.cols, luma.rows, WindowSums(squares, luma.cols, luma.rows), reach,
                 [](std::int64_t sum, int count) { return sum < std::int64_t{limit} * count; });
}

Pixels both(Pixels one, const Pixels& other) {
    std::transform(one.begin(), one.end(), other.begin(), one.begin(),
                   [](std::uint8_t a, std::uint8_t b) -> std::uint8_t { return a != 0 && b != 0 ? 1 : 0; });
    return one;
}

Pixels opposite(Pixels pixels) {
    std::transform(pixels.begin(), pixels.end(), pixels.begin(),
                   [](std::uint8_t value) -> std::uint8_t { return value == 0 ? 1 : 0; });
    return pixels;
}

}  // namespace

std::string_view name(Region region) {
    switch (region) {
        case Region::all: return "all";
        case Region::nonocc: return "nonocc";
        case Region::edges: return "edges";
        case Region::weak_texture: return "weak-texture";
        case Region::background: return "bg";
        case Region::foreground: return "fg";
        case Region::background_nonocc: return "bg-nonocc";
        case Region::foreground_nonocc: return "fg-nonocc";
    }
    return "";
}

std::vector<RegionMask> regions_of(const Scene& scene) {
    Pixels known;
    known.reserve(scene.truth.values.size());
    std::transform(scene.truth.values.begin(), scene.truth.values.end(), std::back_inserter(known),
                   [](float disparity) -> std::uint8_t { return std::isfinite(disparity) ? 1 : 0; });
    const bool knows_visible = !scene.non_occluded.empty();
    const Pixels visible = knows_visible ? both(known, scene.non_occluded) : known;
    std::vector<RegionMask> regions{{Region::all, known}};
    if (knows_visible) {
        regions.push_back({Region::nonocc, visible});
    }
    regions.push_back({Region::edges, both(near_edges(scene.truth), visible)});
    regions.push_back({Region::weak_texture, both(weakly_textured(scene.left), visible)});
    if (!scene.foreground.empty()) {
        regions.push_back({Region::background, both(known, opposite(scene.foreground))});
        regions.push_back({Region::foreground, both(known, scene.foreground)});
        if (knows_visible) {
            regions.push_back({Region::background_nonocc, both(visible, opposite(scene.foreground))});
            regions.push_back({Region::foreground_nonocc, both(visible, scene.foreground)});
        }
    }
    return regions;
}

}  // namespace disparityd::eval
