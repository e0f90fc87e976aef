// SPDX-License-Identifier: Apache-2.0
#include "tools/images/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace disparityd::images {
namespace {

bool is_known(float disparity) {
    return std::isfinite(disparity);
}

/// Returns false for a row without any disparity, which stays.
bool fill_row(std::span<float> row) {
    auto hole = std::find_if_not(row.begin(), row.end(), is_known);
    while (hole != row.end()) {
        const auto end = std::find_if(hole, row.end(), is_known);
        if (hole == row.begin() && end == row.end()) {
            return false;
        }
        const float before = hole == row.begin() ? *end : *(hole - 1);
        const float behind = end == row.end() ? before : *end;
        std::fill(hole, end, std::min(before, behind));
        hole = std::find_if_not(end, row.end(), is_known);
    }
    return true;
}

}  // namespace

FloatMap fill_from_background(FloatMap map) {
    const auto width = static_cast<std::size_t>(map.width);
    std::vector<std::span<float>> rows;
    std::vector<bool> filled;
    for (int y = 0; y < map.height; ++y) {
        rows.push_back(std::span(map.values).subspan(static_cast<std::size_t>(y) * width, width));
        filled.push_back(fill_row(rows.back()));
    }
    const auto first = std::find(filled.begin(), filled.end(), true);
    if (first == filled.end()) {
        return map;
    }
    const auto top = static_cast<std::size_t>(first - filled.begin());
    const auto bottom = static_cast<std::size_t>(filled.rend() - std::find(filled.rbegin(), filled.rend(), true)) - 1;
    for (std::size_t y = 0; y < top; ++y) {
        std::copy(rows[top].begin(), rows[top].end(), rows[y].begin());
    }
    for (std::size_t y = bottom + 1; y < rows.size(); ++y) {
        std::copy(rows[bottom].begin(), rows[bottom].end(), rows[y].begin());
    }
    return map;
}

FloatMap fill_all(FloatMap map) {
    map = fill_from_background(std::move(map));
    const auto width = static_cast<std::ptrdiff_t>(map.width);
    // The first row has some, or no row has.
    for (auto row = map.values.begin() + width; row < map.values.end(); row += width) {
        if (!is_known(*row)) {
            std::copy(row - width, row, row);
        }
    }
    return map;
}

}  // namespace disparityd::images
