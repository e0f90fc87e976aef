// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/corner_matches.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "calibration/board/corners.h"
#include "calibration/online/patch.h"

namespace disparityd::calibration {

namespace {

constexpr double least_correlation = 0.85;

// A second maximum that is nearly as good and farther than this from the best makes a match ambiguous.
constexpr int neighbourhood = 3;
constexpr double least_lead = 0.05;

struct Found {
    Pixel at;
    double correlation = -1;
};

/// Computes the normalised correlation of one patch of one image with patches of the other.
class PatchSearch {
public:
    PatchSearch(Plane<const std::uint8_t> from, Plane<const std::uint8_t> to) : from_(from), to_(to) {}

    struct Window {
        Pixel first;  ///< centres, both ends included
        Pixel last;
    };

    /// Returns the maximum in the window; nothing when it is too low, at the edge of the window, or ambiguous.
    std::optional<Found> best(Pixel corner, Window window) {
        window.first.x = std::max(window.first.x, patch_radius);
        window.last.x = std::min(window.last.x, to_.width - 1 - patch_radius);
        const int width = window.last.x - window.first.x + 1;
        if (width < 3 || window.first.y < patch_radius || window.last.y >= to_.height - patch_radius) {
            return std::nullopt;
        }
        correlate(corner, window, width);
        Found best;
        const auto score = [&](int x, int y) {
            return scores_[static_cast<std::size_t>(y - window.first.y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x - window.first.x)];
        };
        for (int y = window.first.y; y <= window.last.y; ++y) {
            for (int x = window.first.x; x <= window.last.x; ++x) {
                if (score(x, y) > best.correlation) {
                    best = {{x, y}, score(x, y)};
                }
            }
        }
        const bool inside = best.at.x > window.first.x && best.at.x < window.last.x && best.at.y > window.first.y &&
                            best.at.y < window.last.y;
        if (!inside || best.correlation < least_correlation) {
            return std::nullopt;
        }
        for (int y = window.first.y; y <= window.last.y; ++y) {
            for (int x = window.first.x; x <= window.last.x; ++x) {
                const bool near = std::abs(x - best.at.x) <= neighbourhood && std::abs(y - best.at.y) <= neighbourhood;
                if (!near && score(x, y) > best.correlation - least_lead) {
                    return std::nullopt;
                }
            }
        }
        return best;
    }

private:
    /// Fills scores_, row by row. The innermost loops go over the columns of a row, so that the compiler vectorises
    /// them.
    void correlate(Pixel corner, const Window& window, int width) {
        const auto columns = static_cast<std::size_t>(width);
        scores_.clear();
        const PatchSums own = sums_of(from_, corner);
        for (int y = window.first.y; y <= window.last.y; ++y) {
            products_.assign(columns, 0);
            sums_.assign(columns, 0);
            squares_.assign(columns, 0);
            for (int dy = -patch_radius; dy <= patch_radius; ++dy) {
                const std::uint8_t* mine = from_.row(corner.y + dy) + corner.x;
                for (int dx = -patch_radius; dx <= patch_radius; ++dx) {
                    const std::uint8_t* other = to_.row(y + dy) + window.first.x + dx;
                    add_products(mine[dx], other, columns);
                }
            }
            for (std::size_t i = 0; i < columns; ++i) {
                scores_.push_back(own.correlation({sums_[i], squares_[i]}, products_[i]));
            }
        }
    }

    void add_products(int value, const std::uint8_t* other, std::size_t columns) {
        std::int32_t* products = products_.data();
        std::int32_t* sums = sums_.data();
        std::int32_t* squares = squares_.data();
        for (std::size_t i = 0; i < columns; ++i) {
            const std::int32_t pixel = other[i];
            products[i] += value * pixel;
            sums[i] += pixel;
            squares[i] += pixel * pixel;
        }
    }

    Plane<const std::uint8_t> from_;
    Plane<const std::uint8_t> to_;
    std::vector<std::int32_t> products_;
    std::vector<std::int32_t> sums_;
    std::vector<std::int32_t> squares_;
    std::vector<double> scores_;
};

}  // namespace

std::vector<CornerMatch> match_corners(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                       DisparityRange range, int rows, const std::atomic<bool>* give_up) {
    constexpr int squares_per_width = 40;
    constexpr int least_square = 12;
    const int square = std::max(least_square, left.width / squares_per_width);
    PatchSearch to_right(left, right);
    PatchSearch to_left(right, left);
    std::vector<CornerMatch> matches;
    for (const Pixel corner : find_corners(left, square, patch_radius + 1)) {
        if (give_up != nullptr && give_up->load(std::memory_order_relaxed)) {
            break;
        }
        const int last_d = range.first + range.count - 1;
        const int up = std::min(rows, corner.y - patch_radius);
        const int down = std::min(rows, left.height - 1 - patch_radius - corner.y);
        const auto found =
            to_right.best(corner, {{corner.x - last_d, corner.y - up}, {corner.x - range.first, corner.y + down}});
        if (!found) {
            continue;
        }
        const Pixel there = found->at;
        const int top = std::max(corner.y - 2, patch_radius);
        const int bottom = std::min(corner.y + 2, left.height - 1 - patch_radius);
        const auto back = to_left.best(there, {{there.x + range.first, top}, {there.x + last_d, bottom}});
        if (!back || std::abs(back->at.x - corner.x) > 1 || std::abs(back->at.y - corner.y) > 1) {
            continue;
        }
        if (const auto place = refine(left, corner, right, there)) {
            matches.push_back({static_cast<double>(corner.x), static_cast<double>(corner.y), place->x, place->y});
        }
    }
    return matches;
}

}  // namespace disparityd::calibration
