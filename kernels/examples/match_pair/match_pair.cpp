// SPDX-License-Identifier: Apache-2.0
//
// Matches two images that are rectified already, without a daemon.
//   match_pair [SHIFT]: makes a pair that is SHIFT px apart (default 12) and prints the disparity found.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <random>
#include <vector>

#include <kernels/pair_matcher.h>

int main(int argc, char** argv) try {
    constexpr int width = 320, height = 240;
    const int shift = argc > 1 ? std::atoi(argv[1]) : 12;
    std::vector<std::uint8_t> left(width * height), right(width * height);
    std::mt19937 random(1);
    for (std::uint8_t& pixel : left) {
        pixel = static_cast<std::uint8_t>(random());
    }
    for (int i = 0; i < width * height; ++i) {
        right[i] = left[(i + shift + width * height) % (width * height)];
    }

    using namespace disparityd;
    const MatchOptions options = default_options(Method::sgm, {.first = 0, .count = 64});  // 0 .. 63 px
    PairMatcher matcher(width, height, options);
    std::vector<std::int16_t> disparity(width * height);
    PairResults results;
    results.disparity = {disparity.data(), width, height, width};
    Serial one_thread;
    matcher.match({left.data(), width, height, width}, {right.data(), width, height, width}, results, one_thread);

    const std::int16_t found = results.disparity.at(width / 2, height / 2);
    if (found == invalid_disparity(options.range)) {
        std::puts("nothing found");
        return 1;
    }
    std::printf("%.2f px\n", found / 16.0);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "match_pair: error: %s\n", error.what());
    return 1;
}
