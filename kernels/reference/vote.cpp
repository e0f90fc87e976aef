// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>

#include "kernels/noise/noise_level.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

constexpr int radius = 2;

// What the window around (x, y), which has a disparity, leaves of it.
std::int16_t elected(Plane<const std::int16_t> in, std::int16_t invalid, int x, int y) {
    const std::int16_t own = in.at(x, y);
    int pixels = 0;
    int agreeing = 0;
    int sum = 0;  // of differences
    for (int row = std::max(y - radius, 0); row <= std::min(y + radius, in.height - 1); ++row) {
        for (int column = std::max(x - radius, 0); column <= std::min(x + radius, in.width - 1); ++column) {
            const std::int16_t value = in.at(column, row);
            const bool agrees = value != invalid && std::abs(value - own) <= vote_reach;
            ++pixels;
            agreeing += agrees ? 1 : 0;
            sum += agrees ? value - own + vote_reach : 0;  // nothing below 0, so that the quotient is rounded down
        }
    }
    if (100 * agreeing < vote_percent * pixels) {
        return invalid;
    }
    return static_cast<std::int16_t>(own + (sum + agreeing / 2) / agreeing - vote_reach);
}

}  // namespace

void vote(Plane<const std::int16_t> in, std::int16_t invalid, Plane<std::int16_t> out, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < in.width; ++x) {
            out.at(x, y) = in.at(x, y) == invalid ? invalid : elected(in, invalid, x, y);
        }
    }
}

}  // namespace disparityd::reference
