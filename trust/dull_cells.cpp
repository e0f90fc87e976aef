// SPDX-License-Identifier: Apache-2.0
#include "trust/dull_cells.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace disparityd::trust {
namespace {

constexpr int samples_along = 4;  // of a cell, in both directions
constexpr int least_samples = 6;
constexpr int left_out = 1;  // disparities at each end, which may be wrong
constexpr std::int64_t least_cell_texture = 200;
constexpr std::int64_t dull_factor = 9;

/// Whole disparities, both included; none where first > last.
struct Range {
    int first = std::numeric_limits<int>::max();
    int last = std::numeric_limits<int>::min();

    bool known() const { return first <= last; }
    void add(const Range& other) {
        first = std::min(first, other.first);
        last = std::max(last, other.last);
    }
};

/// Returns the texture that an eye surely shows in a cell: none where the picture is cut, whose edge is no texture.
std::int32_t sure_texture(const EyeTexture& eye, std::size_t cell) {
    return eye.cut[cell] ? 0 : eye.coarse[cell];
}

std::size_t cell_at(int row, int column) {
    return static_cast<std::size_t>(row * cell_columns + column);
}

Range measured_range(const FrameView& frame, int row, int column) {
    const int x0 = cell_begin(column, frame.left.width, cell_columns);
    const int y0 = cell_begin(row, frame.left.height, cell_rows);
    const int width = cell_begin(column + 1, frame.left.width, cell_columns) - x0;
    const int height = cell_begin(row + 1, frame.left.height, cell_rows) - y0;
    std::array<int, samples_along * samples_along> values{};
    int count = 0;
    for (int j = 0; j < samples_along; ++j) {
        for (int i = 0; i < samples_along; ++i) {
            const int x = x0 + (2 * i + 1) * width / (2 * samples_along);
            const int y = y0 + (2 * j + 1) * height / (2 * samples_along);
            if (frame.confidence.at(x, y) != 0) {
                values[static_cast<std::size_t>(count++)] = (frame.disparity.at(x, y) + 8) >> 4;
            }
        }
    }
    if (count < least_samples) {
        return {};
    }
    std::sort(values.begin(), values.begin() + count);
    return {values[left_out], values[static_cast<std::size_t>(count - 1 - left_out)]};
}

/// Adds the first known range on the way from a cell, its own not counted.
void add_nearest(const Cells<Range>& measured, int row, int column, int down, int across, Range& range) {
    for (row += down, column += across; row >= 0 && row < cell_rows && column >= 0 && column < cell_columns;
         row += down, column += across) {
        if (measured[cell_at(row, column)].known()) {
            range.add(measured[cell_at(row, column)]);
            return;
        }
    }
}

/// Returns which disparities a left cell may have: its own and those of the nearest known cells in four directions.
Range likely_range(const Cells<Range>& measured, int row, int column) {
    Range range = measured[cell_at(row, column)];
    add_nearest(measured, row, column, 0, -1, range);
    add_nearest(measured, row, column, 0, 1, range);
    add_nearest(measured, row, column, -1, 0, range);
    add_nearest(measured, row, column, 1, 0, range);
    return range;
}

Cells<Range> measured_ranges(const FrameView& frame) {
    Cells<Range> measured;
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            measured[cell_at(row, column)] = measured_range(frame, row, column);
        }
    }
    return measured;
}

/// Columns of the right image, both included.
struct Columns {
    int first;
    int last;

    bool meet(int cell, int width) const {
        return cell_begin(cell, width, cell_columns) <= last && cell_begin(cell + 1, width, cell_columns) > first;
    }
};

/// Returns where the right eye sees what a left cell of these disparities shows.
Columns seen_by_right(const Range& range, int column, int width) {
    return {cell_begin(column, width, cell_columns) - range.last,
            cell_begin(column + 1, width, cell_columns) - 1 - range.first};
}

CellState compared(std::int64_t own, std::int64_t least_of_other) {
    if (least_of_other < least_cell_texture) {
        return CellState::unknown;
    }
    return own * dull_factor < least_of_other ? CellState::dull : CellState::sharp;
}

}  // namespace

void find_dull_cells(const FrameView& frame, const EyeTexture& left, const EyeTexture& right, DullCells& found) {
    const Cells<Range> measured = measured_ranges(frame);
    const int width = frame.left.width;
    found.left.fill(CellState::unknown);
    Cells<std::int32_t> least_of_left;
    least_of_left.fill(std::numeric_limits<std::int32_t>::max());
    Cells<int> farthest_right{};  // the greatest disparity with which a left cell may be seen by a right one
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const Range range = likely_range(measured, row, column);
            if (!range.known()) {
                continue;
            }
            const Columns seen = seen_by_right(range, column, width);
            std::int32_t least = std::numeric_limits<std::int32_t>::max();
            const std::size_t here = cell_at(row, column);
            for (int other = 0; other < cell_columns; ++other) {
                if (seen.meet(other, width)) {
                    const std::size_t there = cell_at(row, other);
                    least = std::min(least, sure_texture(right, there));
                    least_of_left[there] = std::min(least_of_left[there], sure_texture(left, here));
                    farthest_right[there] = std::max(farthest_right[there], range.last);
                }
            }
            if (seen.first >= 0 && seen.last < width && !left.cut[here]) {
                found.left[here] = compared(left.coarse[here], least);
            }
        }
    }
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const std::size_t here = cell_at(row, column);
            const bool seen = least_of_left[here] != std::numeric_limits<std::int32_t>::max() &&
                              cell_begin(column + 1, width, cell_columns) + farthest_right[here] <= width;
            found.right[here] =
                seen && !right.cut[here] ? compared(right.coarse[here], least_of_left[here]) : CellState::unknown;
        }
    }
}

void add_left_cells(const FrameView& frame, const Cells<bool>& right, Cells<bool>& left) {
    const Cells<Range> measured = measured_ranges(frame);
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            const Range range = likely_range(measured, row, column);
            if (!range.known()) {
                continue;
            }
            const Columns seen = seen_by_right(range, column, frame.left.width);
            for (int other = 0; other < cell_columns; ++other) {
                if (right[cell_at(row, other)] && seen.meet(other, frame.left.width)) {
                    left[cell_at(row, column)] = true;
                }
            }
        }
    }
}

}  // namespace disparityd::trust
