// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// At an end of the range with the neighbour equal, or flat.
template <typename T>
bool no_minimum(const T* cost, int count, int k) {
    if (k == 0) {
        return cost[1] == cost[0];
    }
    if (k == count - 1) {
        return cost[k - 1] == cost[k];
    }
    return cost[k - 1] == cost[k] && cost[k] == cost[k + 1];
}

// The least cost among candidates that are no neighbours of the winner.
template <typename T>
int second_min(const T* cost, int count, int k) {
    T least = std::numeric_limits<T>::max();
    for (int i = 0; i < k - 1; ++i) {
        least = std::min(least, cost[i]);
    }
    for (int i = k + 2; i < count; ++i) {
        least = std::min(least, cost[i]);
    }
    return least;
}

}  // namespace

template <typename T>
void local_extrema(Volume<const T> costs, DisparityRange range, const PostOptions& options,
                   Plane<const std::int16_t> winner, Plane<std::int16_t> disparity, Plane<std::uint8_t> confidence,
                   Rows rows) {
    const std::int16_t invalid = invalid_disparity(range);
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < costs.width; ++x) {
            const T* cost = costs.pixel(x, y);
            const int k = winner.at(x, y) - range.first;
            const int least = cost[k];
            const int second = second_min(cost, range.count, k);
            const bool ambiguous = options.uniqueness > 0 && second * (100 - options.uniqueness) <= least * 100;
            if (ambiguous || (options.local_extrema && no_minimum(cost, range.count, k))) {
                disparity.at(x, y) = invalid;
                confidence.at(x, y) = 0;
            } else {
                confidence.at(x, y) = static_cast<std::uint8_t>(second == 0 ? 1 : 1 + 254 * (second - least) / second);
            }
        }
    }
}

template void local_extrema<std::uint8_t>(Volume<const std::uint8_t>, DisparityRange, const PostOptions&,
                                          Plane<const std::int16_t>, Plane<std::int16_t>, Plane<std::uint8_t>, Rows);
template void local_extrema<std::uint16_t>(Volume<const std::uint16_t>, DisparityRange, const PostOptions&,
                                           Plane<const std::int16_t>, Plane<std::int16_t>, Plane<std::uint8_t>, Rows);

}  // namespace disparityd::reference
