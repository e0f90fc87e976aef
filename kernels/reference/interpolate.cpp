// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// A pass over the image from its first pixel to its last, or the other way round, meets four of a pixel's neighbours
// before the pixel itself: these ones, with the signs of the forward pass.
struct Offset {
    int dx = 0;
    int dy = 0;
};
constexpr std::array<Offset, 4> met_before = {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr std::size_t along_row = 0;

/// The nearest measured disparity on the side of each of these neighbours, the pixel itself included; the invalid
/// disparity where there is none.
using Nearest = std::array<std::int16_t, met_before.size()>;

class Interpolation {
public:
    Interpolation(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                  std::span<std::byte> scratch)
        : disparity_(disparity),
          right_winner_(right_winner),
          range_(range),
          invalid_(invalid_disparity(range)),
          forward_(reinterpret_cast<Nearest*>(scratch.data())),
          backward_(forward_ + static_cast<std::size_t>(disparity.width) * static_cast<std::size_t>(disparity.height)) {
    }

    // Two passes carry the nearest disparities along, so that no pixel has to search: the time does not depend on how
    // much was rejected.
    void run() const {
        for (int y = 0; y < disparity_.height; ++y) {
            for (int x = 0; x < disparity_.width; ++x) {
                forward(x, y) = carry(x, y, 1, [this](int nx, int ny) { return forward(nx, ny); });
            }
        }
        for (int y = disparity_.height - 1; y >= 0; --y) {
            for (int x = disparity_.width - 1; x >= 0; --x) {
                backward(x, y) = carry(x, y, -1, [this](int nx, int ny) { return backward(nx, ny); });
                // Its measured neighbours have been carried on from here: it may be overwritten now.
                if (disparity_.at(x, y) == invalid_) {
                    disparity_.at(x, y) = mismatched(x, y)
                                              ? middle(forward(x, y), backward(x, y))
                                              : background(forward(x, y)[along_row], backward(x, y)[along_row]);
                }
            }
        }
    }

private:
    Nearest& forward(int x, int y) const { return forward_[static_cast<std::ptrdiff_t>(y) * disparity_.width + x]; }
    // Of the backward pass, only this row and the one below it are kept.
    Nearest& backward(int x, int y) const { return backward_[(y & 1) * disparity_.width + x]; }

    template <typename Carried>
    Nearest carry(int x, int y, int sign, Carried carried) const {
        Nearest nearest;
        for (std::size_t side = 0; side < nearest.size(); ++side) {
            const int nx = x + sign * met_before[side].dx;
            const int ny = y + sign * met_before[side].dy;
            const bool inside = nx >= 0 && nx < disparity_.width && ny >= 0 && ny < disparity_.height;
            const std::int16_t own = disparity_.at(x, y);
            nearest[side] = own != invalid_ ? own : inside ? carried(nx, ny)[side] : invalid_;
        }
        return nearest;
    }

    // Whether the right image saw something at one of the pixel's candidates: then it is visible in both and was
    // matched wrongly. Otherwise it is occluded.
    bool mismatched(int x, int y) const {
        for (int d = range_.first; d < range_.first + range_.count; ++d) {
            const int right_x = x - d;
            if (right_x >= 0 && right_x < disparity_.width && right_winner_.at(right_x, y) >= range_.first &&
                std::abs(right_winner_.at(right_x, y) - d) <= 1) {
                return true;
            }
        }
        return false;
    }

    std::int16_t background(std::int16_t left, std::int16_t right) const {
        return left == invalid_ ? right : right == invalid_ ? left : std::min(left, right);
    }

    // The lower one of the two middle ones where their number is even.
    std::int16_t middle(const Nearest& before, const Nearest& after) const {
        std::array<std::int16_t, 2 * met_before.size()> sorted;
        std::size_t count = 0;
        for (const Nearest& nearest : {before, after}) {
            for (const std::int16_t value : nearest) {
                if (value != invalid_) {
                    std::size_t i = count++;
                    for (; i > 0 && sorted[i - 1] > value; --i) {
                        sorted[i] = sorted[i - 1];
                    }
                    sorted[i] = value;
                }
            }
        }
        return count == 0 ? invalid_ : sorted[(count - 1) / 2];
    }

    Plane<std::int16_t> disparity_;
    Plane<const std::int16_t> right_winner_;
    DisparityRange range_;
    std::int16_t invalid_;
    Nearest* forward_;
    Nearest* backward_;
};

}  // namespace

std::size_t interpolate_scratch(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height + 2) * sizeof(Nearest);
}

void interpolate(Plane<std::int16_t> disparity, Plane<const std::int16_t> right_winner, DisparityRange range,
                 std::span<std::byte> scratch) {
    Interpolation(disparity, right_winner, range, scratch).run();
}

}  // namespace disparityd::reference
