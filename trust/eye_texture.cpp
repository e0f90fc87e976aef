// SPDX-License-Identifier: Apache-2.0
#include "trust/eye_texture.h"

#include <algorithm>
#include <cstddef>

namespace disparityd::trust {
namespace {

constexpr int reduced_width = 160;
constexpr int coarse_unit = 16;
constexpr int least_fine_step = 4;

int step_of(int width) {
    return std::max(1, (width + reduced_width / 2) / reduced_width);
}

}  // namespace

bool EyeMeter::fits(int width, int height) {
    const int step = step_of(width);
    return width / step >= 4 * cell_columns && height / step >= 4 * cell_rows;
}

EyeMeter::EyeMeter(int width, int height)
    : step_(step_of(width)),
      width_(width / step_),
      height_(height / step_),
      row_sums_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(step_)),
      reduced_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

void EyeMeter::measure(Plane<const std::uint8_t> image, EyeTexture& found) {
    reduce(image);
    found.levels.fill(0);
    for (const std::uint8_t level : reduced_) {
        ++found.levels[level];
    }
    found.reduced_pixels = width_ * height_;
    measure_coarse(found);
    measure_fine(image, found);
    take_noise_off(found);
    find_cut(image, found);
}

/// Writes the means of squares of step_ x step_ pixels, rounded down.
void EyeMeter::reduce(Plane<const std::uint8_t> image) {
    const int columns = width_ * step_;
    // A product instead of a division, which takes longer: exact, as a sum times `pixels` stays below 2^32.
    const auto pixels = static_cast<std::uint64_t>(step_ * step_);
    const std::uint64_t reciprocal = (std::uint64_t{1} << 32) / pixels + 1;
    std::uint8_t* out = reduced_.data();
    for (int y = 0; y < height_; ++y) {
        std::fill(row_sums_.begin(), row_sums_.end(), std::uint16_t{0});
        for (int k = 0; k < step_; ++k) {
            const std::uint8_t* in = image.row(y * step_ + k);
            for (int x = 0; x < columns; ++x) {
                row_sums_[static_cast<std::size_t>(x)] =
                    static_cast<std::uint16_t>(row_sums_[static_cast<std::size_t>(x)] + in[x]);
            }
        }
        const std::uint16_t* sums = row_sums_.data();
        for (int x = 0; x < width_; ++x, sums += step_) {
            std::uint64_t sum = 0;
            for (int k = 0; k < step_; ++k) {
                sum += sums[k];
            }
            *out++ = static_cast<std::uint8_t>(sum * reciprocal >> 32);
        }
    }
}

/// Second differences: a ramp, such as the rim of a shadow, has none.
void EyeMeter::measure_coarse(EyeTexture& found) const {
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const int x1 = std::min(cell_begin(column + 1, width_, cell_columns), width_ - 1);
            const int y1 = std::min(cell_begin(row + 1, height_, cell_rows), height_ - 1);
            std::int64_t sum = 0;
            std::int64_t count = 0;
            for (int y = std::max(cell_begin(row, height_, cell_rows), 1); y < y1; ++y) {
                const std::uint8_t* p = reduced_.data() + static_cast<std::ptrdiff_t>(y) * width_;
                for (int x = std::max(cell_begin(column, width_, cell_columns), 1); x < x1; ++x) {
                    const int across = 2 * p[x] - p[x - 1] - p[x + 1];
                    const int down = 2 * p[x] - p[x - width_] - p[x + width_];
                    sum += across * across + down * down;
                    ++count;
                }
            }
            found.coarse[static_cast<std::size_t>(row * cell_columns + column)] =
                static_cast<std::int32_t>(coarse_unit * sum / count);
        }
    }
}

/// What lies outside of the captured picture is black after rectification, and reaches the image's outline.
void EyeMeter::find_cut(Plane<const std::uint8_t> image, EyeTexture& found) const {
    constexpr std::ptrdiff_t enough = 4;  // pixels of the outline; noise makes single ones black
    const auto black_in_row = [](const std::uint8_t* row, int from, int to) {
        return std::count(row + from, row + to, 0);
    };
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            std::ptrdiff_t black = 0;
            const int left = cell_begin(column, image.width, cell_columns);
            const int right = cell_begin(column + 1, image.width, cell_columns);
            if (row == 0 || row == cell_rows - 1) {
                black += black_in_row(image.row(row == 0 ? 0 : image.height - 1), left, right);
            }
            if (column == 0 || column == cell_columns - 1) {
                const int at = column == 0 ? 0 : image.width - 1;
                for (int y = cell_begin(row, image.height, cell_rows); y < cell_begin(row + 1, image.height, cell_rows);
                     ++y) {
                    black += image.row(y)[at] == 0 ? 1 : 0;
                }
            }
            for (int y = cell_begin(row, height_, cell_rows); y < cell_begin(row + 1, height_, cell_rows); ++y) {
                black += enough * black_in_row(reduced_.data() + static_cast<std::ptrdiff_t>(y) * width_,
                                               cell_begin(column, width_, cell_columns),
                                               cell_begin(column + 1, width_, cell_columns));
            }
            found.cut[static_cast<std::size_t>(row * cell_columns + column)] = black >= enough;
        }
    }
}

/// The mean of step_ x step_ pixels has less noise by that number; two changes are summed.
void EyeMeter::take_noise_off(EyeTexture& found) const {
    const std::int32_t noise = 2 * coarse_unit * low_value(found.fine) / (step_ * step_);
    for (std::int32_t& coarse : found.coarse) {
        coarse = std::max(coarse - noise, 0);
    }
}

/// Looks at every fourth row, or at fewer of a large image.
void EyeMeter::measure_fine(Plane<const std::uint8_t> image, EyeTexture& found) const {
    const int row_step = std::max(step_, least_fine_step);
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const int x0 = std::max(cell_begin(column, image.width, cell_columns), 2);
            const int x1 = std::min(cell_begin(column + 1, image.width, cell_columns), image.width - 2);
            const int y1 = cell_begin(row + 1, image.height, cell_rows);
            std::int64_t sum = 0;
            std::int64_t count = 0;
            for (int y = cell_begin(row, image.height, cell_rows); y < y1; y += row_step) {
                const std::uint8_t* p = image.row(y);
                std::int32_t of_row = 0;
                for (int x = x0; x < x1; ++x) {
                    const int change = 2 * p[x] - p[x - 2] - p[x + 2];
                    of_row += change * change;
                }
                sum += of_row;
                count += x1 - x0;
            }
            found.fine[static_cast<std::size_t>(row * cell_columns + column)] = static_cast<std::int32_t>(sum / count);
        }
    }
}

}  // namespace disparityd::trust
