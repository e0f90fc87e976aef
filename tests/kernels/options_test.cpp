// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kernels/match_fields.h"
#include "kernels/matcher.h"

namespace disparityd {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Options, MethodsHaveNames) {
    for (const Method method : all_methods) {
        EXPECT_EQ(method_from_name(to_string(method)), method);
    }
    EXPECT_EQ(to_string(Method::census), "census");
    EXPECT_FALSE(method_from_name("SGM"));
    EXPECT_FALSE(method_from_name(""));
}

TEST(Options, DefaultsAreFine) {
    for (const Method method : all_methods) {
        const MatchOptions options = default_options(method, {-16, 96});
        EXPECT_EQ(validate(options), "");
        EXPECT_EQ(options.method, method);
        EXPECT_EQ(options.range.first, -16);
        EXPECT_EQ(options.range.count, 96);
    }
}

// A covered lens is unknown, whatever is chosen.
TEST(Options, EveryDefaultAsksForTexture) {
    for (const Method method : all_methods) {
        EXPECT_GT(default_options(method).post.min_texture, 0) << to_string(method);
    }
    for (const Preset preset : all_presets) {
        EXPECT_GT(preset_options(preset).post.min_texture, 0) << to_string(preset);
    }
}

TEST(Options, PresetsAreFine) {
    for (const Preset preset : all_presets) {
        const MatchOptions options = preset_options(preset, {-16, 96});
        EXPECT_EQ(validate(options), "");
        EXPECT_EQ(options.range.first, -16);
        EXPECT_EQ(options.range.count, 96);
    }
}

struct Bad {
    std::string_view what;
    void (*spoil)(MatchOptions&);
    std::string_view found;
    std::string_view allowed;
};

TEST(Options, ProblemSaysWhatWasFoundAndWhatIsAllowed) {
    const Bad table[] = {
        {"disparities", [](MatchOptions& o) { o.range.count = 60; }, "60", "multiple of 16"},
        {"disparities", [](MatchOptions& o) { o.range.count = 0; }, "0", "16 .. 256"},
        {"disparities", [](MatchOptions& o) { o.range.count = 272; }, "272", "16 .. 256"},
        {"disparities", [](MatchOptions& o) { o.range.count = -16; }, "-16", "16 .. 256"},
        {"d_min", [](MatchOptions& o) { o.range.first = -257; }, "-257", "-256 .. 256"},
        {"d_min", [](MatchOptions& o) { o.range.first = 1000000; }, "1000000", "-256 .. 256"},
        {"paths", [](MatchOptions& o) { o.sgm.paths = 5; }, "5", "4 or 8"},
        {"p1", [](MatchOptions& o) { o.sgm.p1 = 0; }, "0", "1 .. 192"},
        {"p1", [](MatchOptions& o) { o.sgm.p1 = 63; }, "63", "1 .. 62"},
        {"p2", [](MatchOptions& o) { o.sgm.p2 = 194; }, "194", "2 .. 193"},
        {"p2", [](MatchOptions& o) { o.sgm.p2 = 1; }, "1", "2 .. 193"},
        {"uniqueness", [](MatchOptions& o) { o.post.uniqueness = 100; }, "100", "0 .. 99"},
        {"uniqueness", [](MatchOptions& o) { o.post.uniqueness = -1; }, "-1", "0 .. 99"},
        {"median", [](MatchOptions& o) { o.post.median = 4; }, "4", "0, 3 or 5"},
        {"p2_slope", [](MatchOptions& o) { o.sgm.p2_slope = 9; }, "9", "1 .. 8"},
        {"p2_slope", [](MatchOptions& o) { o.sgm.p2_slope = 0; }, "0", "1 .. 8"},
        {"p2_min", [](MatchOptions& o) { o.sgm.p2_min = 64; }, "64", "0 .. 63"},
        {"p2_min", [](MatchOptions& o) { o.sgm.p2_min = -1; }, "-1", "0 .. 193"},
        {"guided_median", [](MatchOptions& o) { o.post.guided_median = 3; }, "3", "0, 5 or 7"},
        {"speckle_size", [](MatchOptions& o) { o.post.speckle_size = -1; }, "-1", "0 .. 1000000"},
        {"min_texture", [](MatchOptions& o) { o.post.min_texture = 100; }, "100", "0 .. 99"},
        {"speckle_step", [](MatchOptions& o) { o.post.speckle_step = 257; }, "257", "0 .. 256"},
        {"noise_level", [](MatchOptions& o) { o.noise_level = 4; }, "4", "0 .. 3"},
        {"noise_level", [](MatchOptions& o) { o.noise_level = 2; }, "2", "4 paths"},
        {"cost", [](MatchOptions& o) { o.cost = static_cast<CensusCost>(7); }, "",
         "census-9x7 and census-7x5+gradient"},
        {"method", [](MatchOptions& o) { o.method = static_cast<Method>(9); }, "", "sad, census and sgm"},
    };
    for (const Bad& bad : table) {
        MatchOptions options = default_options(Method::sgm);
        options.sgm.p1 = 10;
        options.sgm.p2 = 63;
        bad.spoil(options);
        EXPECT_THAT(validate(options), AllOf(HasSubstr(bad.what), HasSubstr(bad.found), HasSubstr(bad.allowed)));
        EXPECT_THROW(backend("auto").create({8, 8, options}), std::invalid_argument);
    }
}

TEST(Backends, AreFoundByName) {
    EXPECT_EQ(backend("reference").name, "reference");
    EXPECT_EQ(backend("cpu").name, "cpu");
    EXPECT_EQ(backend("auto").name, backends().front().available() ? "cuda" : "cpu");
    for (const Backend& row : backends()) {
        EXPECT_FALSE(row.description.empty());
        EXPECT_EQ(row.unavailable_because().empty(), row.available()) << row.name;
    }
    try {
        backend("gpu");
        FAIL() << "there is no such back end";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("gpu"), HasSubstr("auto"), HasSubstr("cpu"), HasSubstr("reference")));
    }
}

TEST(Backends, RefuseImpossibleSizes) {
    for (const auto& [width, height] : {std::pair{0, 8}, {8, 0}, {-1, 8}, {8193, 8}, {8, 8193}}) {
        EXPECT_THROW(backend("cpu").create({width, height, default_options(Method::sad)}), std::invalid_argument);
    }
}

TEST(Options, OnlySgmHasCalibratedConfidences) {
    for (const Method method : all_methods) {
        MatchOptions options = default_options(method);
        EXPECT_FALSE(calibrates_confidence(options));
        options.sgm.calibrated_confidence = true;
        EXPECT_EQ(calibrates_confidence(options), method == Method::sgm);
    }
}

}  // namespace
}  // namespace disparityd
