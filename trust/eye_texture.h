// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/image.h"

/// Measures of step 15 of docs/algorithm.md: how far a frame can be trusted.
namespace disparityd::trust {

/// An image is judged in cells, row by row.
inline constexpr int cell_columns = 16;
inline constexpr int cell_rows = 9;
inline constexpr int cell_count = cell_columns * cell_rows;

template <typename T>
using Cells = std::array<T, cell_count>;

/// Returns the first pixel of cell `index` where `size` pixels are shared by `cells`; that of cell `cells` is the end.
constexpr int cell_begin(int index, int size, int cells) {
    return index * size / cells;
}

/// What one eye shows of texture and brightness.
struct EyeTexture {
    Cells<std::int32_t> coarse{};  ///< per cell: mean square of changes of the reduced image, without noise, in 1/16
    Cells<std::int32_t> fine{};    ///< per cell: mean square of changes over 2 px, noise included
    Cells<bool> cut{};             ///< per cell: some of it is black, as where a rectified picture shows nothing
    std::array<std::int32_t, 256> levels{};  ///< of the reduced image: pixels of each grey level
    std::int32_t reduced_pixels = 0;
};

/// Returns the value that a tenth of the cells are below: of fine textures, the noise or a little more.
template <typename T>
T low_value(Cells<T> values) {
    std::sort(values.begin(), values.end());
    return values[cell_count / 10];
}

/// Measures one eye. Holds the reduced image, so that nothing is allocated per frame. One thread.
class EyeMeter {
public:
    /// The rectified size.
    EyeMeter(int width, int height);

    /// Whether an image of this size is large enough to be judged.
    static bool fits(int width, int height);

    void measure(Plane<const std::uint8_t> image, EyeTexture& found);

private:
    void reduce(Plane<const std::uint8_t> image);
    void measure_coarse(EyeTexture& found) const;
    void find_cut(Plane<const std::uint8_t> image, EyeTexture& found) const;
    void take_noise_off(EyeTexture& found) const;
    void measure_fine(Plane<const std::uint8_t> image, EyeTexture& found) const;

    int step_;  ///< pixels of the image, in each direction, for one of the reduced image
    int width_;
    int height_;
    std::vector<std::uint16_t> row_sums_;
    std::vector<std::uint8_t> reduced_;
};

}  // namespace disparityd::trust
