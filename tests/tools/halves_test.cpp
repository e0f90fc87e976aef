// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/halves.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>

namespace disparityd::eval {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;

using Names = std::vector<std::string>;

const Names& twelve() {
    static const Names names{"adirondack", "aloe",  "art",      "baby1",    "cones", "dolls",
                             "motorcycle", "piano", "reindeer", "sawtooth", "teddy", "tsukuba"};
    return names;
}

TEST(HalvesTest, SameHalvesOnEveryMachine) {
    // From an implementation of the documented shuffle in another language.
    const Halves seed_1 = split_in_halves(twelve(), 1);
    EXPECT_EQ(seed_1.seed, 1U);
    EXPECT_THAT(seed_1.a, ElementsAre("adirondack", "art", "reindeer", "sawtooth", "teddy", "tsukuba"));
    EXPECT_THAT(seed_1.b, ElementsAre("aloe", "baby1", "cones", "dolls", "motorcycle", "piano"));
    const Halves seed_7 = split_in_halves(twelve(), 7);
    EXPECT_THAT(seed_7.a, ElementsAre("adirondack", "dolls", "motorcycle", "piano", "reindeer", "sawtooth"));
    EXPECT_THAT(seed_7.b, ElementsAre("aloe", "art", "baby1", "cones", "teddy", "tsukuba"));
}

TEST(HalvesTest, DisjointAndEveryScene) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        const Halves halves = split_in_halves(twelve(), seed);
        EXPECT_EQ(halves.a.size(), 6U);
        Names both = halves.a;
        both.insert(both.end(), halves.b.begin(), halves.b.end());
        std::sort(both.begin(), both.end());
        EXPECT_THAT(both, ElementsAreArray(twelve())) << "seed " << seed;
        for (const std::string& name : twelve()) {
            EXPECT_EQ(halves.in_a(name), std::count(halves.a.begin(), halves.a.end(), name) == 1);
        }
    }
}

TEST(HalvesTest, OrderAndRepetitionOfNamesDoNotMatter) {
    Names others = twelve();
    std::reverse(others.begin(), others.end());
    others.emplace_back("cones");
    const Halves halves = split_in_halves(others, 7);
    EXPECT_EQ(halves.a, split_in_halves(twelve(), 7).a);
    EXPECT_EQ(halves.b, split_in_halves(twelve(), 7).b);
}

TEST(HalvesTest, OddNumbersGiveTheFirstHalfOneMore) {
    const Halves halves = split_in_halves({"a", "b", "c", "d", "e"}, 3);
    EXPECT_THAT(halves.a, ElementsAre("c", "d", "e"));
    EXPECT_THAT(halves.b, ElementsAre("a", "b"));
}

TEST(HalvesTest, EverySceneIsInEitherHalfEquallyOften) {
    std::map<std::string, int> in_a;
    constexpr int seeds = 2000;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        for (const std::string& name : split_in_halves(twelve(), seed).a) {
            ++in_a[name];
        }
    }
    for (const std::string& name : twelve()) {
        EXPECT_NEAR(in_a[name], 0.5 * seeds, 120) << name << ": more than 5 sigma";
    }
}

TEST(HalvesTest, OneSceneIsRefused) {
    try {
        split_in_halves({"cones", "cones"}, 3);
        FAIL() << "not refused";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), HasSubstr("--halves: found 1 scene in DATA, allowed: at least 2"));
    }
}

}  // namespace
}  // namespace disparityd::eval
