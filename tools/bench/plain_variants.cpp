// SPDX-License-Identifier: Apache-2.0
// Compiled twice: see naive.h.
#include "tools/bench/plain_variants.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "kernels/steps.h"

namespace disparityd::bench::DISPARITYD_BENCH_BUILD {

namespace {

constexpr int radius_x = 4;
constexpr int radius_y = 3;
constexpr std::uint16_t sad_outside = 9 * 7 * 255;
constexpr std::uint8_t census_outside = 62;

template <typename T>
T replicated(Plane<const T> image, int x, int y) {
    return image.at(std::clamp(x, 0, image.width - 1), std::clamp(y, 0, image.height - 1));
}

// The image of absolute differences has its own border replicated, not the two images.
std::uint16_t window_sum(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, int x, int y, int d) {
    int sum = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            const int column = std::clamp(x + dx, 0, left.width - 1);
            sum += std::abs(replicated(left, column, y + dy) - replicated(right, column - d, y + dy));
        }
    }
    return static_cast<std::uint16_t>(sum);
}

template <typename T>
std::uint64_t census_word(Plane<const T> image, int x, int y) {
    const T centre = image.at(x, y);
    std::uint64_t word = 0;
    for (int dy = -radius_y; dy <= radius_y; ++dy) {
        for (int dx = -radius_x; dx <= radius_x; ++dx) {
            if (dx != 0 || dy != 0) {
                word = word << 1 | (replicated(image, x + dx, y + dy) < centre ? 1U : 0U);
            }
        }
    }
    return word;
}

/// Sets every cost: cost_of(x, y, d) inside the right image, `outside` elsewhere.
template <typename T, typename CostOf>
void fill(Volume<T> costs, DisparityRange range, Rows rows, T outside, CostOf cost_of) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < costs.width; ++x) {
            for (int k = 0; k < range.count; ++k) {
                const int d = range.first + k;
                costs.pixel(x, y)[k] = x - d >= 0 && x - d < costs.width ? cost_of(x, y, d) : outside;
            }
        }
    }
}

void sad_in_one_pass(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, DisparityRange range,
                     Volume<std::uint16_t> costs, Rows rows) {
    fill(costs, range, rows, sad_outside, [&](int x, int y, int d) { return window_sum(left, right, x, y, d); });
}

void pixels_as_words(Plane<const std::uint8_t> image, Plane<std::uint64_t> words, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        std::copy_n(image.row(y), image.width, words.row(y));
    }
}

void matching_cost_in_one_pass(Plane<const std::uint64_t> left, Plane<const std::uint64_t> right, DisparityRange range,
                               Volume<std::uint8_t> costs, Rows rows) {
    fill(costs, range, rows, census_outside, [&](int x, int y, int d) {
        return static_cast<std::uint8_t>(__builtin_popcountll(census_word(left, x, y) ^ census_word(right, x - d, y)));
    });
}

// By value: compilers vectorise loops over this where std::min's references stop them.
constexpr std::uint8_t lesser(std::uint8_t a, std::uint8_t b) {
    return a < b ? a : b;
}

// The reference's form of the recursion, see kernels/reference/aggregate.cpp.
std::uint8_t min_once(const std::uint8_t* __restrict cost, int disparities, int p1, int p2,
                      const std::uint8_t* __restrict before, std::uint8_t min_before, std::uint8_t* __restrict path) {
    const auto penalty = static_cast<std::uint8_t>(p1);
    const auto jump = static_cast<std::uint8_t>(p2);
    const auto largest_neighbour = static_cast<std::uint8_t>(p2 - p1);
    std::array<std::uint8_t, max_disparities + 2> capped;  // one more at both ends, where no neighbour is
    std::uint8_t* __restrict middle = capped.data() + 1;
    for (int k = 0; k < disparities; ++k) {
        middle[k] = lesser(static_cast<std::uint8_t>(before[k] - min_before), jump);
    }
    middle[-1] = jump;
    middle[disparities] = jump;
    std::uint8_t least = 255;
    for (int k = 0; k < disparities; ++k) {
        const std::uint8_t neighbour = lesser(lesser(middle[k - 1], middle[k + 1]), largest_neighbour);
        path[k] =
            static_cast<std::uint8_t>(cost[k] + lesser(middle[k], static_cast<std::uint8_t>(neighbour + penalty)));
        least = lesser(least, path[k]);
    }
    return least;
}

// The recursion as it is written in step 5.
std::uint8_t min_per_candidate(const std::uint8_t* __restrict cost, int disparities, int p1, int p2,
                               const std::uint8_t* __restrict before, std::uint8_t /*min_before*/,
                               std::uint8_t* __restrict path) {
    std::uint8_t min_of_path = 255;
    for (int k = 0; k < disparities; ++k) {
        std::uint8_t least = 255;
        for (int i = 0; i < disparities; ++i) {
            least = lesser(least, before[i]);
        }
        int best = std::min<int>(before[k], least + p2);
        best = k > 0 ? std::min(best, before[k - 1] + p1) : best;
        best = k + 1 < disparities ? std::min(best, before[k + 1] + p1) : best;
        path[k] = static_cast<std::uint8_t>(cost[k] + best - least);
        min_of_path = lesser(min_of_path, path[k]);
    }
    return min_of_path;
}

// Where a path comes from, with the signs of the first sweep: three from the row before, one along the row.
struct Step {
    int dx;
    int dy;
};
constexpr std::array<Step, 4> steps_before = {{{-1, -1}, {0, -1}, {1, -1}, {-1, 0}}};
constexpr std::size_t paths = steps_before.size();

// Path costs of this row and of the one before.
class SweepRows {
public:
    SweepRows(int width, int disparities, std::span<std::uint8_t> memory)
        : width_(width), disparities_(disparities), costs_(memory.data()), least_(costs_ + cells() * candidates()) {}

    static std::size_t bytes(int width, int disparities) {
        return 2 * paths * static_cast<std::size_t>(width) * static_cast<std::size_t>(disparities + 1);
    }

    std::uint8_t* costs(int y, std::size_t path, int x) const { return costs_ + cell(y, path, x) * candidates(); }
    std::uint8_t& least(int y, std::size_t path, int x) const { return least_[cell(y, path, x)]; }

private:
    std::size_t candidates() const { return static_cast<std::size_t>(disparities_); }
    std::size_t cells() const { return 2 * paths * static_cast<std::size_t>(width_); }
    std::size_t cell(int y, std::size_t path, int x) const {
        return (static_cast<std::size_t>(y & 1) * paths + path) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    int width_;
    int disparities_;
    std::uint8_t* costs_;
    std::uint8_t* least_;
};

class Sweep {
public:
    Sweep(Volume<const std::uint8_t> costs, int p1, int p2, Volume<std::uint16_t> sums, SweepRows rows,
          ContinuePath continue_path)
        : costs_(costs), p1_(p1), p2_(p2), sums_(sums), rows_(rows), continue_(continue_path) {}

    /// `sign` 1: from the first pixel to the last, sums are set; -1: the other way round, sums are added to.
    void run(int sign) const {
        for (int i = 0; i < costs_.height; ++i) {
            for (int k = 0; k < costs_.width; ++k) {
                const int x = sign > 0 ? k : costs_.width - 1 - k;
                const int y = sign > 0 ? i : costs_.height - 1 - i;
                for (std::size_t path = 0; path < paths; ++path) {
                    advance(path, x, y, sign);
                }
                add(x, y, sign > 0);
            }
        }
    }

private:
    void advance(std::size_t path, int x, int y, int sign) const {
        const std::uint8_t* cost = costs_.pixel(x, y);
        const int before_x = x + sign * steps_before[path].dx;
        const int before_y = y + sign * steps_before[path].dy;
        std::uint8_t* out = rows_.costs(y, path, x);
        const bool inside = before_x >= 0 && before_x < costs_.width && before_y >= 0 && before_y < costs_.height;
        if (inside) {
            rows_.least(y, path, x) =
                continue_(cost, costs_.disparities, p1_, p2_, rows_.costs(before_y, path, before_x),
                          rows_.least(before_y, path, before_x), out);
        } else {
            std::copy_n(cost, costs_.disparities, out);
            rows_.least(y, path, x) = *std::min_element(cost, cost + costs_.disparities);
        }
    }

    void add(int x, int y, bool first) const {
        std::uint16_t* __restrict sum = sums_.pixel(x, y);
        const std::uint8_t* a = rows_.costs(y, 0, x);
        const std::uint8_t* b = rows_.costs(y, 1, x);
        const std::uint8_t* c = rows_.costs(y, 2, x);
        const std::uint8_t* d = rows_.costs(y, 3, x);
        if (first) {
            std::fill_n(sum, costs_.disparities, std::uint16_t{0});
        }
        for (int k = 0; k < costs_.disparities; ++k) {
            sum[k] = static_cast<std::uint16_t>(sum[k] + a[k] + b[k] + c[k] + d[k]);
        }
    }

    Volume<const std::uint8_t> costs_;
    int p1_;
    int p2_;
    Volume<std::uint16_t> sums_;
    SweepRows rows_;
    ContinuePath continue_;
};

void aggregate_in_two_sweeps(Volume<const std::uint8_t> costs, int p1, int p2, Volume<std::uint16_t> sums,
                             std::span<std::uint8_t> scratch, ContinuePath continue_path) {
    const Sweep sweep(costs, p1, p2, sums, SweepRows(costs.width, costs.disparities, scratch), continue_path);
    sweep.run(1);
    sweep.run(-1);
}

}  // namespace

extern const PlainVariants variants;
const PlainVariants variants = {
    .sad_in_one_pass = sad_in_one_pass,
    .pixels_as_words = pixels_as_words,
    .matching_cost_in_one_pass = matching_cost_in_one_pass,
    .aggregate_in_two_sweeps = aggregate_in_two_sweeps,
    .two_sweeps_scratch = SweepRows::bytes,
    .min_once = min_once,
    .min_per_candidate = min_per_candidate,
};

}  // namespace disparityd::bench::DISPARITYD_BENCH_BUILD
