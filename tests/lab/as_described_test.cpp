// SPDX-License-Identifier: Apache-2.0
#include "lab/paper/as_described.h"

#include <sstream>

#include <gmock/gmock.h>

#include "kernels/reference/steps.h"
#include "lab/paper/paper_tables.h"
#include "tests/kernels/support.h"

namespace disparityd::lab {
namespace {

using test::Image;
using test::noise;
using test::pick;
using test::Random;

template <typename T>
struct OwnedVolume {
    OwnedVolume(int width, int height, int disparities)
        : values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                 static_cast<std::size_t>(disparities)),
          view{values.data(), width, height, disparities} {}
    std::vector<T> values;
    Volume<T> view;
};

TEST(AsDescribed, CostsEqualTheReference) {
    Random random(1);
    const MatchingSteps& steps = steps_as_described().matching;
    const CensusSteps& census = steps.of(CensusCost::census_9x7);
    for (int round = 0; round < 20; ++round) {
        const int width = pick(random, 1, 40), height = pick(random, 1, 12);
        const DisparityRange range{pick(random, -20, 20), 16 * pick(random, 1, 4)};
        auto left = noise(random, width, height), right = noise(random, width, height);
        OwnedVolume<std::uint16_t> sad(width, height, range.count), expected_sad(width, height, range.count);
        steps.sad(left.plane(), right.plane(), range, sad.view, left.rows());
        reference::sad(left.plane(), right.plane(), range, expected_sad.view, left.rows());
        ASSERT_EQ(sad.values, expected_sad.values) << width << "x" << height;

        Image<std::uint64_t> left_words(width, height), right_words(width, height);
        OwnedVolume<std::uint8_t> costs(width, height, range.count), expected(width, height, range.count);
        census.census(left.plane(), left_words.plane(), left.rows());
        census.census(right.plane(), right_words.plane(), left.rows());
        census.matching_cost(left_words.plane(), right_words.plane(), range, costs.view, left.rows());
        reference::census(left.plane(), left_words.plane(), left.rows());
        reference::census(right.plane(), right_words.plane(), left.rows());
        reference::matching_cost(left_words.plane(), right_words.plane(), range, expected.view, left.rows());
        ASSERT_EQ(costs.values, expected.values) << width << "x" << height;
    }
}

TEST(PaperTables, PutTimesBesideThePapers) {
    std::vector<bench::Measurement> measured;
    const auto add = [&](const char* name, const char* isa, int threads, double ms) {
        bench::Measurement one;
        one.scene = "cones";
        one.disparities = 128;
        one.name = name;
        one.isa = isa;
        one.threads = threads;
        one.ms = {ms};
        measured.push_back(one);
    };
    add("cpu/sgm", "AVX2", 1, 8);
    add("cpu/sgm", "AVX2", 2, 4);
    add("naive/sgm", "scalar", 1, 400);
    add("naive/sgm", "compiled", 1, 80);
    add("paper/sgm", "scalar", 1, 800);
    std::ostringstream text;
    print_paper_tables(measured, text);
    EXPECT_THAT(text.str(),
                testing::HasSubstr("| Cones (128) | 4286 | 81 | 53x | 800.00 | 400.00 | 80.00 | 8.00 | 4.00 | "
                                   "100x / 200x | 50x / 100x | 10x / 20x |"));
    EXPECT_THAT(text.str(), testing::Not(testing::HasSubstr("Teddy")));
}

}  // namespace
}  // namespace disparityd::lab
