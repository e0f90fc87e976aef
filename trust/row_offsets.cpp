// SPDX-License-Identifier: Apache-2.0
#include "trust/row_offsets.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>

namespace disparityd::trust {
namespace {

constexpr int patch = 8;  // px, in both directions
constexpr int patches_across = 20;
constexpr int patches_down = 12;
/// The disparity of a pair whose rows do not fit may be off, where an edge is slanted.
constexpr int sideways_px = 2;
constexpr int least_offsets = 30;  // of a band
constexpr int agreeing = 12;       // 1/16 px: those of wrong matches differ by more
constexpr int least_curvature = 2 * patch * patch;

using Costs = std::array<int, 2 * RowOffsets::reach_px + 1>;

int sum_of(const std::uint8_t* p, std::ptrdiff_t stride) {
    int sum = 0;
    for (int y = 0; y < patch; ++y, p += stride) {
        for (int x = 0; x < patch; ++x) {
            sum += p[x];
        }
    }
    return sum;
}

/// The sum of absolute differences; `lift` is added to the right patch.
int difference(const std::uint8_t* left, std::ptrdiff_t left_stride, const std::uint8_t* right,
               std::ptrdiff_t right_stride, int lift) {
    int sum = 0;
    for (int y = 0; y < patch; ++y, left += left_stride, right += right_stride) {
        for (int x = 0; x < patch; ++x) {
            sum += std::abs(left[x] - right[x] - lift);
        }
    }
    return sum;
}

/// Returns the offset in 1/16 px where the costs have one clear minimum inside of the reach: the equiangular fit.
std::optional<int> offset_of(const Costs& costs) {
    const auto best = std::min_element(costs.begin(), costs.end());
    const auto at = best - costs.begin();
    if (at == 0 || at + 1 == static_cast<std::ptrdiff_t>(costs.size())) {
        return std::nullopt;
    }
    const int above = *(best - 1) - *best;
    const int below = *(best + 1) - *best;
    const int steeper = std::max(above, below);
    if (above + below < least_curvature || above + below < *best / 2) {
        return std::nullopt;
    }
    const int whole = (static_cast<int>(at) - RowOffsets::reach_px) * RowOffsets::unit;
    return whole + (above - below) * RowOffsets::unit / 2 / steeper;
}

/// Returns the offset of the patch around a left pixel; nothing where it was not measured, or shows too little.
std::optional<int> patch_offset(const FrameView& frame, int x, int y) {
    constexpr int margin = RowOffsets::reach_px;
    if (frame.confidence.at(x, y) == 0) {
        return std::nullopt;
    }
    const int left_x = x - patch / 2;
    const int top = y - patch / 2;
    const int right_x = left_x - ((frame.disparity.at(x, y) + 8) >> 4);
    if (top < margin || top + patch + margin > frame.left.height || left_x < 0 || left_x + patch > frame.left.width ||
        right_x < sideways_px || right_x + patch + sideways_px > frame.right.width) {
        return std::nullopt;
    }
    const std::uint8_t* left = frame.left.row(top) + left_x;
    const std::uint8_t* right = frame.right.row(top) + right_x;
    const int lift = (sum_of(left, frame.left.stride) - sum_of(right, frame.right.stride)) / (patch * patch);
    Costs costs;
    for (int dy = -margin; dy <= margin; ++dy) {
        int least = std::numeric_limits<int>::max();
        for (int dx = -sideways_px; dx <= sideways_px; ++dx) {
            least = std::min(least, difference(left, frame.left.stride, right + dy * frame.right.stride + dx,
                                               frame.right.stride, lift));
        }
        costs[static_cast<std::size_t>(dy + margin)] = least;
    }
    return offset_of(costs);
}

}  // namespace

void RowOffsets::add(const FrameView& frame, std::uint32_t turn) {
    const int width = frame.left.width;
    const int height = frame.left.height;
    const int shift_x = static_cast<int>(turn % 2);
    const int shift_y = static_cast<int>(turn / 2 % 2);
    for (int row = 0; row < patches_down; ++row) {
        for (int column = 0; column < patches_across; ++column) {
            const int x = (4 * column + 1 + 2 * shift_x) * width / (4 * patches_across);
            const int y = (4 * row + 1 + 2 * shift_y) * height / (4 * patches_down);
            if (const auto offset = patch_offset(frame, x, y)) {
                for (const int band : {y * bands_along / height, bands_along + x * bands_along / width}) {
                    ++offsets_[static_cast<std::size_t>(band)][static_cast<std::size_t>(*offset + reach_px * unit)];
                }
            }
        }
    }
}

std::optional<int> RowOffsets::median(int band) const {
    const auto& offsets = offsets_[static_cast<std::size_t>(band)];
    const int count = std::accumulate(offsets.begin(), offsets.end(), 0);
    if (count < least_offsets) {
        return std::nullopt;
    }
    int seen = 0;
    int bin = 0;
    while (2 * (seen + offsets[static_cast<std::size_t>(bin)]) <= count) {
        seen += offsets[static_cast<std::size_t>(bin)];
        ++bin;
    }
    const auto near_median = offsets.begin() + std::max(bin - agreeing, 0);
    const int agree = std::accumulate(near_median, offsets.begin() + std::min(bin + agreeing + 1, bins), 0);
    return 5 * agree >= 3 * count ? std::optional(bin - reach_px * unit) : std::nullopt;
}

}  // namespace disparityd::trust
