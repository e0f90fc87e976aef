// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/step_work.h"

#include <bit>

#include "kernels/cpu/sgm/path_kernels.h"

namespace disparityd::bench {
namespace {

// Operations on bytes per candidate.
constexpr double sad_operations = 10;  // two differences (row in, row out), two updates of a column, two of a window
constexpr double cost_operations = 8 + 8 + 7;  // xor, count, add up the eight bytes of a word
constexpr double path_operations = 7;    // - least, min with P2, min of neighbours, + P1, min, + C, min over candidates
constexpr double winner_operations = 9;  // least and where, least of the others, least of the right image and where

// Per pixel.
constexpr double census_operations = 2 * 62 * 2.0;  // of both images: compare, and put the bit in its place
constexpr double census_bytes = 2 * (1 + 8.0);      // image in, words out
constexpr double words_in = 2 * 8.0;
constexpr double images_in = 2;
constexpr double winners_out = 2 + 2 + 1 + 2.0;  // winner, disparity, confidence, right winner

constexpr double exchange = 2 * 2.0;  // minimum and maximum of 16 bits
constexpr double median3_exchanges = 19, median5_exchanges = 99;
// Of a sample: difference of two intensities, compared, and the sample chosen.
constexpr double likeness = 3;
// Of a bit of a sample: still chosen, set, and added up. A byte holds eight.
constexpr double sample_bit = 4 / 8.0;

/// Bytes of a sum of path costs of one of two sweeps.
double sum_bytes(const MatchOptions& options) {
    return cpu::sums_need_u16(options.sgm) ? 2 : 1;
}

double aggregate_operations(const MatchOptions& options, double bytes_of_sum) {
    return options.sgm.paths * (path_operations + bytes_of_sum);
}

StepWork post_process(const MatchOptions& options, double pixels) {
    const PostOptions& post = options.post;
    StepWork work;
    if (post.left_right_check) {
        work.bytes += (2 + 2 + 2 + 2) * pixels;
        work.byte_operations += 4 * 2 * pixels;
    }
    if (post.median > 0) {
        work.bytes += (2 + 2) * pixels;
        work.byte_operations += exchange * (post.median == 3 ? median3_exchanges : median5_exchanges) * pixels;
    }
    if (post.speckle_size > 0) {
        work.bytes += (2 + 4 + 4) * pixels;                // disparities, labels out and in
        work.byte_operations += 2 * (3 * 2 + 4) * pixels;  // two neighbours: compared and joined
    }
    if (post.min_texture > 0) {
        work.bytes += (1 + 1) * pixels;                    // the pair
        work.byte_operations += 2 * (4 + 4 * 2) * pixels;  // sums of columns, gradient and ramp, and the other eye's
    }
    if (post.guided_median > 0) {
        const int samples = post.guided_median * post.guided_median;
        const int bits = std::bit_width(16U * static_cast<unsigned>(options.range.count));
        work.bytes += (2 + 1 + 2) * pixels;
        work.byte_operations += (likeness + sample_bit * bits) * samples * pixels;
    }
    work.bytes += (2 + 1) * pixels;  // confidence of what was rejected
    work.byte_operations += 3 * pixels;
    return work;
}

}  // namespace

std::optional<StepWork> step_work(const std::string& step, const MatchOptions& options, double pixels) {
    const double candidates = pixels * options.range.count;
    const double cost_bytes = options.method == Method::sad ? 2 : 1;
    if (step == "census") {
        return StepWork{census_bytes * pixels, census_operations * pixels, 0};
    }
    if (step == "sad") {
        return StepWork{images_in * pixels + 2 * candidates, sad_operations * candidates, 0};
    }
    if (step == "dsi") {
        return StepWork{words_in * pixels + candidates, cost_operations * candidates, 0};
    }
    if (step == "aggregate") {
        // Each path reads the costs; the first writes sums of 16 bits, the others read and write them.
        const double bytes = options.sgm.paths * (1 + 2 + 2.0) - 2;
        return StepWork{bytes * candidates, aggregate_operations(options, 2) * candidates, 2 * candidates};
    }
    if (step == "wta") {
        const double width = options.method == Method::census ? 1 : 2;
        return StepWork{width * candidates + winners_out * pixels, width * winner_operations * candidates, 0};
    }
    if (step == "sad+wta") {
        return StepWork{(images_in + winners_out) * pixels, (sad_operations + 2 * winner_operations) * candidates, 0};
    }
    if (step == "dsi+wta") {
        return StepWork{(words_in + winners_out) * pixels,
                        (cost_operations + cost_bytes * winner_operations) * candidates, 0};
    }
    if (step == "dsi+aggregate+wta") {
        const double sum = sum_bytes(options);
        const double volume = (1 + sum) * candidates;  // costs, and the sums of the first sweep
        const double add_up = 3 * 2;                   // both sums and the costs, 16 bits
        return StepWork{
            2 * volume + (words_in + winners_out) * pixels,
            (cost_operations + aggregate_operations(options, sum) + add_up + 2 * winner_operations) * candidates,
            volume};
    }
    if (step == "post-process") {
        return post_process(options, pixels);
    }
    return std::nullopt;
}

std::string step_work_legend() {
    return "bound: the longer one of bytes / copy rate (half of them read, half written; rate of the cache where "
           "volumes "
           "fit it)\nand operations on bytes / the rate of independent minima and sums in registers. Both are counted "
           "from the algorithm\n(tools/bench/step_work.cpp): what is lost to dependencies, shuffles and caches is not "
           "in "
           "them.";
}

}  // namespace disparityd::bench
