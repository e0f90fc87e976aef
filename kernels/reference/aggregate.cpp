// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

namespace {

// The step from a pixel to the next one on a path. Pixels linked by it form a line; lines share no pixel.
struct Direction {
    int dx = 0;
    int dy = 0;
};

constexpr std::array<Direction, 8> directions = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {-1, 1}, {1, -1}}};

// By value: compilers vectorise loops over this where std::min's references stop them.
constexpr std::uint8_t lesser(std::uint8_t a, std::uint8_t b) {
    return a < b ? a : b;
}

class PathAggregation {
public:
    PathAggregation(Volume<const std::uint8_t> costs, Plane<const std::uint8_t> left, const SgmOptions& options,
                    Volume<std::uint16_t> sums, std::span<std::byte> scratch)
        : costs_(costs),
          left_(left),
          options_(options),
          sums_(sums),
          path_(reinterpret_cast<std::uint8_t*>(scratch.data())),
          least_(path_ + static_cast<std::size_t>(left.width + left.height - 1) *
                             static_cast<std::size_t>(costs.disparities)) {}

    int lines(Direction r) const {
        return r.dy == 0 ? costs_.height : r.dx == 0 ? costs_.width : costs_.width + costs_.height - 1;
    }

    /// Lines [first, last) of one direction, all of them side by side so that memory is walked row by row.
    void run(Direction r, int first, int last, bool first_direction) const {
        const int width = costs_.width;
        const int height = costs_.height;
        for (int i = 0; i < height; ++i) {
            const int y = r.dy >= 0 ? i : height - 1 - i;
            if (r.dy == 0) {
                if (y >= first && y < last) {
                    for (int k = 0; k < width; ++k) {
                        advance(r, y, r.dx > 0 ? k : width - 1 - k, y, first_direction);
                    }
                }
                continue;
            }
            // line = x + shift
            const int shift = r.dx == 0 ? 0 : r.dx == r.dy ? height - 1 - y : y;
            const int last_x = std::min(last - shift, width);
            for (int x = std::max(first - shift, 0); x < last_x; ++x) {
                advance(r, x + shift, x, y, first_direction);
            }
        }
    }

private:
    // One pixel: its line's path costs, those of the previous pixel, become this pixel's.
    void advance(Direction r, int line, int x, int y, bool first_direction) const {
        const int disparities = costs_.disparities;
        const std::uint8_t* cost = costs_.pixel(x, y);
        std::uint8_t* path = path_ + static_cast<std::size_t>(line) * static_cast<std::size_t>(disparities);
        std::uint8_t& least = least_[line];
        const int before_x = x - r.dx;
        const int before_y = y - r.dy;
        if (before_x < 0 || before_x >= costs_.width || before_y < 0 || before_y >= costs_.height) {
            std::copy_n(cost, disparities, path);
            least = *std::min_element(cost, cost + disparities);
        } else {
            int p2 = options_.p2;
            if (options_.adaptive_p2) {
                const int difference = std::abs(left_.at(x, y) - left_.at(before_x, before_y));
                p2 = std::max({options_.p1 + 1, options_.p2_min, p2 - options_.p2_slope * difference});
            }
            least = continue_path(cost, disparities, options_.p1, p2, least, path);
        }
        add(path, disparities, first_direction, sums_.pixel(x, y));
    }

    // The recursion of step 5, relative to the least cost of the previous pixel: nothing exceeds 62 + P2, bytes
    // suffice.
    static std::uint8_t continue_path(const std::uint8_t* __restrict cost, int disparities, int p1, int p2,
                                      std::uint8_t min_before, std::uint8_t* __restrict path) {
        const auto penalty = static_cast<std::uint8_t>(p1);
        const auto limit = static_cast<std::uint8_t>(p2);
        const auto largest_neighbour = static_cast<std::uint8_t>(p2 - p1);
        std::array<std::uint8_t, max_disparities + 2> before;  // one more at both ends, where no neighbour is
        std::uint8_t* __restrict middle = before.data() + 1;
        for (int d = 0; d < disparities; ++d) {
            middle[d] = lesser(static_cast<std::uint8_t>(path[d] - min_before), limit);
        }
        middle[-1] = limit;
        middle[disparities] = limit;
        std::uint8_t least = 255;
        for (int d = 0; d < disparities; ++d) {
            const std::uint8_t neighbour = lesser(lesser(middle[d - 1], middle[d + 1]), largest_neighbour);
            const std::uint8_t step = lesser(middle[d], static_cast<std::uint8_t>(neighbour + penalty));
            path[d] = static_cast<std::uint8_t>(cost[d] + step);
            least = lesser(least, path[d]);
        }
        return least;
    }

    static void add(const std::uint8_t* __restrict path, int disparities, bool first_direction,
                    std::uint16_t* __restrict sum) {
        if (first_direction) {
            std::copy_n(path, disparities, sum);
            return;
        }
        for (int d = 0; d < disparities; ++d) {
            sum[d] = static_cast<std::uint16_t>(sum[d] + path[d]);
        }
    }

    Volume<const std::uint8_t> costs_;
    Plane<const std::uint8_t> left_;
    SgmOptions options_;
    Volume<std::uint16_t> sums_;
    std::uint8_t* path_;   // per line: L of the pixel last visited
    std::uint8_t* least_;  // per line: the least of them
};

}  // namespace

std::size_t aggregate_scratch(int width, int height, int disparities) {
    return static_cast<std::size_t>(width + height - 1) * static_cast<std::size_t>(disparities + 1);
}

void aggregate(Volume<const std::uint8_t> costs, Plane<const std::uint8_t> left, const SgmOptions& options,
               Volume<std::uint16_t> sums, std::span<std::byte> scratch, Parallel& workers) {
    const PathAggregation aggregation(costs, left, options, sums, scratch);
    for (int i = 0; i < options.paths; ++i) {
        const Direction r = directions[static_cast<std::size_t>(i)];
        const int lines = aggregation.lines(r);
        const int blocks = std::min(lines, 4 * workers.workers());
        workers.for_each(blocks, [&](int block) {
            aggregation.run(r, lines * block / blocks, lines * (block + 1) / blocks, i == 0);
        });
    }
}

}  // namespace disparityd::reference
