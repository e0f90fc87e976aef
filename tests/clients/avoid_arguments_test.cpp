// SPDX-License-Identifier: Apache-2.0
//
// The programs that avoid obstacles refuse the same arguments in the same words, on one line.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/clients/avoid_programs.h"

namespace disparityd::test {
namespace {

using Words = std::vector<std::string>;

class AvoidArgumentsTest : public ::testing::TestWithParam<AvoidProgram> {
protected:
    void SetUp() override {
        if (const std::string missing = GetParam().missing(); !missing.empty()) {
            GTEST_SKIP() << missing;
        }
    }

    /// Returns what the program says on standard error; it must end with status 2.
    std::string refusal(const Words& arguments) {
        const auto program = GetParam().start(folder_, arguments);
        EXPECT_EQ(program->wait_for_exit(), 2);
        return program->log();
    }

    TemporaryFolder folder_;
};

TEST_P(AvoidArgumentsTest, ThatAreOutOfRange) {
    for (const auto& [arguments, allowed] : std::vector<std::pair<Words, std::string>>{
             {{"--width-m", "0"}, "0.01 .. 10"},
             {{"--margin-m", "-1"}, "0.05 .. 10"},
             {{"--smallest-m", "1.1"}, "0 .. 1"},
             {{"--speed-mps", "fast"}, "0.05 .. 20"},
             {{"--deceleration-mps2", "nan"}, "0.05 .. 20"},
             {{"--reaction-s", "10.5"}, "0 .. 10"},
             {{"--max-age-ms", "inf"}, "10 .. 10000"},
             {{"--good-frames", "2.5"}, "whole numbers 1 .. 1000"},
             {{"--camera-height-m", "-0.1"}, "0 .. 100"},
             {{"--camera-pitch-deg", "46"}, "-45 .. 45"},
         }) {
        const std::string said = refusal(arguments);
        EXPECT_TRUE(said.starts_with(std::string(GetParam().name()) + ": error: ")) << said;
        EXPECT_TRUE(said.ends_with(arguments[0] + ": found \"" + arguments[1] + "\", allowed: " + allowed + "\n"))
            << said;
        EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    }
}

TEST_P(AvoidArgumentsTest, ThatAreWrong) {
    for (const Words& arguments : std::vector<Words>{
             {"--nonsense"}, {"--width-m"}, {"one", "two"}, {"a/b"}, {"tcp:host"}, {"tcp:host:0"}, {"unix:"}, {""}}) {
        const std::string said = refusal(arguments);
        EXPECT_TRUE(said.starts_with(std::string(GetParam().name()) + ": error: ")) << said;
        EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    }
}

TEST_P(AvoidArgumentsTest, Help) {
    const auto program = GetParam().start(folder_, {"--help"});
    EXPECT_TRUE(program->wait_for_line([](const std::string& line) { return line.starts_with("  --max-age-ms"); }));
    EXPECT_EQ(program->wait_for_exit(), 0);
    EXPECT_EQ(program->log(), "");
}

INSTANTIATE_TEST_SUITE_P(Programs, AvoidArgumentsTest, ::testing::Values(AvoidProgram{false}, AvoidProgram{true}),
                         [](const auto& made) { return language_of(made.param); });

}  // namespace
}  // namespace disparityd::test
