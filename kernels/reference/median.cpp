// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// Partial insertion sort would do less, but a fixed sequence of min and max has no branches that data can mispredict.
template <std::size_t count>
std::int16_t median_of(std::array<std::int16_t, count>& values) {
    for (std::size_t pass = 0; pass <= count / 2; ++pass) {
        for (std::size_t i = pass + 1; i < count; ++i) {
            const std::int16_t smaller = std::min(values[pass], values[i]);
            values[i] = std::max(values[pass], values[i]);
            values[pass] = smaller;
        }
    }
    return values[count / 2];
}

template <int radius>
void median_filter(Plane<const std::int16_t> in, std::int16_t invalid, Plane<std::int16_t> out, Rows rows) {
    constexpr int side = 2 * radius + 1;
    for (int y = rows.first; y < rows.last; ++y) {
        std::array<const std::int16_t*, side> window_rows{};
        for (int i = 0; i < side; ++i) {
            window_rows[static_cast<std::size_t>(i)] = in.row(std::clamp(y - radius + i, 0, in.height - 1));
        }
        for (int x = 0; x < in.width; ++x) {
            const std::int16_t centre = in.at(x, y);
            std::array<std::int16_t, static_cast<std::size_t>(side) * side> window;
            std::size_t i = 0;
            for (const std::int16_t* row : window_rows) {
                for (int dx = -radius; dx <= radius; ++dx) {
                    const std::int16_t value = row[std::clamp(x + dx, 0, in.width - 1)];
                    window[i++] = value == invalid ? centre : value;
                }
            }
            out.at(x, y) = centre == invalid ? invalid : median_of(window);
        }
    }
}

}  // namespace

void median(Plane<const std::int16_t> in, std::int16_t invalid, int size, Plane<std::int16_t> out, Rows rows) {
    if (size == 3) {
        median_filter<1>(in, invalid, out, rows);
    } else {
        median_filter<2>(in, invalid, out, rows);
    }
}

}  // namespace disparityd::reference
