// SPDX-License-Identifier: Apache-2.0
#include "obstacles/right_view.h"

#include <algorithm>
#include <array>
#include <limits>

namespace disparityd::scan {
namespace {

/// No column: beyond all others, so that it lies behind nothing.
constexpr std::int16_t none = std::numeric_limits<std::int16_t>::max();
/// A thing is tried at disparities that differ by this part, or by one pixel.
constexpr int step_part = 16;
/// What shows the same pixel in both eyes may be off by so many columns.
constexpr int tolerance = 1;

}  // namespace

RightView::RightView(const Geometry& geometry)
    : width_(geometry.camera().width),
      sources_(index(geometry.groups()) * index(width_)),
      known_(index(geometry.groups())),
      behind_(index(width_) + 1) {}

void RightView::begin(const Pixels& pixels) {
    pixels_ = pixels;
    std::fill(known_.begin(), known_.end(), std::uint8_t{0});
}

/// Returns the sources of a group's middle row, of what is measured as the scan has it. Of two left pixels that the
/// right eye sees in one column, it sees the nearer one, which is farther to the right in the left image.
const std::int16_t* RightView::row_of(const Geometry& geometry, int group) {
    std::int16_t* const sources = &sources_[index(group) * index(width_)];
    if (known_[index(group)] != 0) {
        return sources;
    }
    known_[index(group)] = 1;
    std::fill(sources, sources + width_, none);
    const int y = group_middle(group, geometry.camera().height);
    const int offset = geometry.camera().scale.offset16;
    const std::uint16_t* const weights = geometry.weights(group);
    const std::int16_t* const disparity = pixels_.disparity.row(y);
    const std::uint8_t* const confidence = pixels_.confidence.row(y);
    for (int x = 0; x < width_; ++x) {
        const int right = x - ((disparity[x] + 8) >> 4);
        const bool seen = at_horizontal_distance(disparity[x] + offset, weights[x]) >= geometry.limits().seen;
        if (confidence[x] != 0 && seen && right >= 0 && right < width_) {
            sources[right] = static_cast<std::int16_t>(x);
        }
    }
    return sources;
}

/// Adds up, from column `begin` on and up to `first`, those that show something to the left of the left image's column
/// `first`: what would stand in that column, or to the right of it, would hide that.
void RightView::add_up(const std::int16_t* row, int begin, int first) {
    int sum = 0;
    for (int x = begin; x < first; ++x) {
        behind_[index(x)] = static_cast<std::int16_t>(sum);
        sum += row[x] < first - tolerance ? 1 : 0;
    }
    behind_[index(first)] = static_cast<std::int16_t>(sum);
}

/// Whether a thing twice as wide as `half` may be seen in this column of the right image: on one of its sides, as far
/// as the image goes, less than half of the columns show what lies behind. Columns are added up up to `added`.
bool RightView::may_stand(int at, int half, int added) const {
    constexpr int least_part = 4;
    const int begin = std::max(at - half + 1, 0);
    const int end = std::min(at + half, width_);
    if (at < 0 || least_part * (at + 1 - begin) < half || least_part * (end - at) < half) {
        return true;  // too little of it would be in view
    }
    const auto sum = [&](int column) { return behind_[index(std::min(column, added))]; };
    return 2 * (sum(at + 1) - sum(begin)) < at + 1 - begin || 2 * (sum(end) - sum(at)) < end - at;
}

Clear RightView::clear(const Geometry& geometry, int group, int first, int end) {
    const Camera& camera = geometry.camera();
    const auto k = static_cast<double>(camera.scale.k);
    const std::uint16_t* const weights = geometry.weights(group);
    const auto [least, greatest] = std::minmax(weights[first], weights[end - 1]);
    if (least == 0) {
        return {};
    }
    // The disparity of the nearest thing that is asked for, px, and the width of the smallest one at each.
    const int most = (geometry.limits().nearest * weight_one / least - camera.scale.offset16) / 16;
    const double width_per_sixteenth = camera.f * 1000 * geometry.options().object_m / k;
    const auto half_of = [&](int disparity) {
        return static_cast<int>(width_per_sixteenth * (16 * disparity + camera.scale.offset16) / 2);
    };
    const std::array columns{first, (first + end - 1) / 2, end - 1};
    add_up(row_of(geometry, group), std::max(0, first - most - half_of(most)), first);
    int nearest = 0;
    int farthest = 0;
    for (int disparity = most; disparity > 0; disparity -= std::max(1, disparity / step_part)) {
        const int half = half_of(disparity);
        const bool clear = half > 0 && std::none_of(columns.begin(), columns.end(), [&](int column) {
                               return may_stand(column - disparity, half, first);
                           });
        if (!clear && nearest > 0) {
            break;
        }
        nearest = clear && nearest == 0 ? disparity : nearest;
        farthest = clear ? disparity : farthest;
    }
    const auto distance = [&](int disparity, std::uint16_t weight) {
        return k / std::max(at_horizontal_distance(16 * disparity + camera.scale.offset16, weight), 1);
    };
    if (nearest == 0) {
        return {};
    }
    return {nearest == most ? 0 : distance(nearest, least), distance(farthest, greatest)};
}

}  // namespace disparityd::scan
