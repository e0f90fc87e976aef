// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr int radius_x = 4;
constexpr int radius_y = 3;

}  // namespace

void census(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows) {
    const int width = image.width;
    std::array<std::uint8_t, max_side + 2 * radius_x> padded;  // one row of the window with its border replicated
    std::array<std::uint16_t, max_side> bits;                  // what this row of the window adds to each pixel's word
    for (int y = rows.first; y < rows.last; ++y) {
        const std::uint8_t* __restrict centre = image.row(y);
        std::uint64_t* __restrict word = words.row(y);
        std::fill_n(word, width, std::uint64_t{0});
        for (int dy = -radius_y; dy <= radius_y; ++dy) {
            const std::uint8_t* row = image.row(std::clamp(y + dy, 0, image.height - 1));
            std::fill_n(padded.begin(), radius_x, row[0]);
            std::copy_n(row, width, padded.begin() + radius_x);
            std::fill_n(padded.begin() + radius_x + width, radius_x, row[width - 1]);
            std::fill_n(bits.begin(), width, std::uint16_t{0});
            int count = 0;
            for (int dx = -radius_x; dx <= radius_x; ++dx) {
                if (dx == 0 && dy == 0) {
                    continue;
                }
                const std::uint8_t* __restrict neighbour = padded.data() + radius_x + dx;
                for (int x = 0; x < width; ++x) {
                    const int bit = neighbour[x] < centre[x] ? 1 : 0;
                    std::uint16_t& all = bits[static_cast<std::size_t>(x)];
                    all = static_cast<std::uint16_t>(all << 1 | bit);
                }
                ++count;
            }
            for (int x = 0; x < width; ++x) {
                word[x] = word[x] << count | bits[static_cast<std::size_t>(x)];
            }
        }
    }
}

}  // namespace disparityd::reference
