// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr int radius_x = 4;
constexpr int radius_y = 3;
constexpr int window_width = 2 * radius_x + 1;
constexpr int window_height = 2 * radius_y + 1;
constexpr std::uint16_t outside = window_width * window_height * 255;

// A row of the right image from its end to its start, so that the candidates of a pixel lie in ascending order;
// the border is replicated as far as candidates reach.
class MirroredRow {
public:
    void set(const std::uint8_t* row, int width, DisparityRange range) {
        first_x_ = width - 1 - range.first;
        const int last_x = -(range.first + range.count - 1);
        for (int x = first_x_; x >= last_x; --x) {
            pixels_[static_cast<std::size_t>(first_x_ - x)] = row[std::clamp(x, 0, width - 1)];
        }
    }

    /// The candidates of left column x: the pixel at x - d for d = range.first and on.
    const std::uint8_t* candidates(int x, DisparityRange range) const {
        return &pixels_[static_cast<std::size_t>(first_x_ - (x - range.first))];
    }

private:
    int first_x_ = 0;
    std::array<std::uint8_t, max_side + max_disparities> pixels_;
};

/// Sums over the window's height, one per candidate.
using Column = std::array<std::uint16_t, max_disparities>;

// The columns under a window: column x is at x modulo the window's width.
class ColumnRing {
public:
    Column& operator[](int x) { return columns_[static_cast<std::size_t>(x % window_width)]; }

private:
    std::array<Column, window_width> columns_;
};

// The rows under the windows of one row of pixels.
class WindowRows {
public:
    WindowRows(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range)
        : left_(left), right_(right), range_(range) {}

    void move_to(int y) {
        for (int i = 0; i < window_height; ++i) {
            const int window_y = std::clamp(y + i - radius_y, 0, left_.height - 1);
            left_rows_[static_cast<std::size_t>(i)] = left_.row(window_y);
            mirrored_[static_cast<std::size_t>(i)].set(right_.row(window_y), left_.width, range_);
        }
    }

    void sum_column(int x, Column& column) const {
        std::uint16_t* __restrict sums = column.data();
        std::fill_n(sums, range_.count, std::uint16_t{0});
        for (std::size_t i = 0; i < window_height; ++i) {
            const std::uint8_t pixel = left_rows_[i][x];
            const std::uint8_t* __restrict candidates = mirrored_[i].candidates(x, range_);
            for (int k = 0; k < range_.count; ++k) {
                const std::uint8_t candidate = candidates[k];
                const auto larger = pixel > candidate ? pixel : candidate;
                const auto smaller = pixel > candidate ? candidate : pixel;
                sums[k] = static_cast<std::uint16_t>(sums[k] + static_cast<std::uint8_t>(larger - smaller));
            }
        }
    }

private:
    Plane<const std::uint8_t> left_;
    Plane<const std::uint8_t> right_;
    DisparityRange range_;
    std::array<const std::uint8_t*, window_height> left_rows_{};
    std::array<MirroredRow, window_height> mirrored_;
};

/// The window around column x: columns beyond the border are those at it.
void sum_window(ColumnRing& columns, int x, int width, int disparities, std::uint16_t* __restrict cost) {
    std::fill_n(cost, disparities, std::uint16_t{0});
    for (int dx = -radius_x; dx <= radius_x; ++dx) {
        const std::uint16_t* __restrict column = columns[std::clamp(x + dx, 0, width - 1)].data();
        for (int k = 0; k < disparities; ++k) {
            cost[k] = static_cast<std::uint16_t>(cost[k] + column[k]);
        }
    }
}

}  // namespace

void sad(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
         Volume<std::uint16_t> costs, Rows rows) {
    const int width = left.width;
    WindowRows window(left, right, range);
    ColumnRing columns;
    for (int y = rows.first; y < rows.last; ++y) {
        window.move_to(y);
        for (int x = 0; x < std::min(radius_x, width); ++x) {
            window.sum_column(x, columns[x]);
        }
        for (int x = 0; x < width; ++x) {
            if (x + radius_x < width) {
                window.sum_column(x + radius_x, columns[x + radius_x]);
            }
            std::uint16_t* cost = costs.pixel(x, y);
            sum_window(columns, x, width, range.count, cost);
            for (int k = 0; k < range.count; ++k) {
                const int candidate = x - (range.first + k);
                cost[k] = candidate >= 0 && candidate < width ? cost[k] : outside;
            }
        }
    }
}

}  // namespace disparityd::reference
