// SPDX-License-Identifier: Apache-2.0
#include "kernels/fallback_matcher.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr std::array<std::string_view, 1> rectify_steps = {"rectify"};
constexpr std::array<std::string_view, 3> match_steps = {"upload", "wta", "download"};
constexpr std::array<StageInfo, 2> two_stages = {
    {{StageKind::rectify, rectify_steps}, {StageKind::match, match_steps, 1}}};
constexpr std::size_t scratch_of_second = 100;

class TwoStages : public Matcher {
public:
    const MatcherConfig& config() const override { return config_; }
    std::size_t scratch_bytes() const override { return 0; }
    std::span<const StageInfo> stages() const override { return two_stages; }

private:
    MatcherConfig config_{8, 4, {}};
};

/// A device that is lost.
class Lost final : public TwoStages {
    void run(int /*stage*/, const FrameView& /*frame*/, Parallel& /*workers*/,
             std::span<std::chrono::nanoseconds> /*step_times*/) override {
        throw std::runtime_error("the device is lost");
    }
};

/// What goes on in its place; it wants `next_scratch` bytes and writes all that it is given.
class Second final : public TwoStages {
public:
    std::size_t scratch_bytes() const override { return next_scratch; }
    void run(int /*stage*/, const FrameView& frame, Parallel& /*workers*/,
             std::span<std::chrono::nanoseconds> step_times) override {
        std::fill(step_times.begin(), step_times.end(), std::chrono::nanoseconds(5));
        ASSERT_EQ(frame.scratch.size(), scratch_of_second);
        std::fill(frame.scratch.begin(), frame.scratch.end(), std::byte{1});
        ++runs;
    }

    static inline std::size_t next_scratch = 0;
    static inline int runs = 0;
};

bool everywhere() {
    return true;
}
std::string nothing() {
    return {};
}
std::unique_ptr<Matcher> create_second(const MatcherConfig& /*config*/) {
    return std::make_unique<Second>();
}
constexpr Backend second_row = {"second", "", everywhere, create_second, nothing};

// Were the second matcher kept without its scratch, the next frame would be written to nowhere.
TEST(FallbackMatcher, WithoutMemoryForTheSecondTheNextFrameTriesAgain) {
    FallbackMatcher matcher(std::make_unique<Lost>(), second_row);
    Serial serial;
    FrameView frame;
    std::array<std::chrono::nanoseconds, 3> times{};
    Second::next_scratch = std::numeric_limits<std::size_t>::max() / 4;
    Second::runs = 0;
    for (int i = 0; i < 2; ++i) {
        EXPECT_THROW(matcher.run(1, frame, serial, times), std::runtime_error);
        EXPECT_EQ(matcher.substitute(), "");
        EXPECT_EQ(Second::runs, 0);
    }
    Second::next_scratch = scratch_of_second;
    matcher.run(1, frame, serial, times);
    EXPECT_EQ(Second::runs, 1);
    EXPECT_THAT(times, testing::ElementsAre(0ns, 15ns, 0ns)) << "the winner step shows the whole time";
    EXPECT_EQ(matcher.substitute(), "second");
    EXPECT_THAT(matcher.trouble(), HasSubstr("the device is lost; the back end second goes on"));
}

}  // namespace
}  // namespace disparityd::test
