// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// One small pair, two rounds.
Outcome bench(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--pair", "64x48x16", "--rounds", "2"});
    return run(DISPARITY_BENCH, arguments);
}

TEST(BenchTest, JsonIsAListWithTheAgreedKeys) {
    const Outcome outcome = bench({"--json", "-", "--threads", "1", "--threads", "2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto list = nlohmann::json::parse(outcome.out);
    std::multiset<std::string> names;
    for (const auto& one : list) {
        names.insert(one["name"]);
        EXPECT_EQ(one["scene"], "rendered");
        EXPECT_EQ(one["width"], 64);
        EXPECT_EQ(one["height"], 48);
        EXPECT_EQ(one["disparities"], 16);
        EXPECT_TRUE(one["isa"].is_string());
        EXPECT_GE(one["threads"], 1);
        EXPECT_GT(one["median_ms"], 0);
        EXPECT_GT(one["min_ms"], 0);
        EXPECT_LE(one["min_ms"], one["median_ms"]);
        EXPECT_TRUE(one.contains("memory_mb"));
    }
    for (const char* threaded : {"cpu/sgm", "cpu/sad", "cpu/census", "opencv/bm", "opencv/3way"}) {
        EXPECT_EQ(names.count(threaded), 2U) << threaded;
    }
    EXPECT_EQ(names.count("opencv/hh"), 1U);
    for (const char* naive : {"naive/sgm", "naive/sad", "naive/census"}) {
        EXPECT_EQ(names.count(naive), 2U) << naive << ", as compiled and not vectorised";
    }
}

TEST(BenchTest, MemoryIsWhatAMatcherHolds) {
    const auto list = nlohmann::json::parse(bench({"--json", "-", "--contestant", "naive", "--contestant", "cpu"}).out);
    constexpr double candidates = 64 * 48 * 16 / 1e6;
    for (const auto& one : list) {
        // SGM of plain steps: a byte for the cost and two for the sum of each candidate.
        if (one["name"] == "naive/sgm") {
            EXPECT_GE(one["memory_mb"], 3 * candidates);
        }
        EXPECT_GT(one["memory_mb"], 64 * 48 * 5 / 1e6) << one << ": its planes at least";
        EXPECT_LT(one["memory_mb"], 20) << one;
    }
}

TEST(BenchTest, TablesSayWhatWasMeasured) {
    const Outcome outcome = bench({"--contestant", "cpu", "--contestant", "opencv/3way", "--contestant", "naive/sgm"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("rendered 64x48, D 16"), HasSubstr("x 3WAY"), HasSubstr("cpu/census"),
                                   HasSubstr("scalar"), HasSubstr("naive/sgm")));
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("OpenCV 4"), HasSubstr("baseline"), HasSubstr("leaves out the left D - 1")));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("bound / time"), HasSubstr("cpu/sgm census"), HasSubstr("GB/s")));
    EXPECT_THAT(bench({"--contestant", "opencv", "--markdown"}).out, HasSubstr("| opencv/bm |"));
    EXPECT_THAT(bench({"--contestant", "cpu", "--no-roofline"}).out, Not(HasSubstr("bound / time")));
}

TEST(BenchTest, OptionsThatNoContestantUsesAreRefused) {
    EXPECT_THAT(bench({"--contestant", "cpu/sad", "--p1", "4"}).err,
                HasSubstr("--p1: only the method sgm uses it, found: sad"));
    EXPECT_THAT(bench({"--contestant", "opencv/bm", "--paths", "4"}).err, HasSubstr("found: no method of ours"));
    EXPECT_EQ(bench({"--contestant", "cpu/sgm", "--p1", "4", "--no-roofline"}).exit_code, 0);
}

TEST(BenchTest, EveryInstructionSetCanBeAskedFor) {
    const Outcome all = bench({"--json", "-", "--contestant", "cpu/sad", "--isa", "all", "--threads", "1"});
    ASSERT_EQ(all.exit_code, 0) << all.err;
    for (const auto& one : nlohmann::json::parse(all.out)) {
        const Outcome single = bench({"--json", "-", "--contestant", "cpu/sad", "--isa", one["isa"], "--threads", "1"});
        const auto list = nlohmann::json::parse(single.out);
        ASSERT_EQ(list.size(), 1U);
        EXPECT_EQ(list[0]["isa"], one["isa"]);
    }
}

TEST(BenchTest, NaiveRunsOnLargePairsOnlyWhenNamed) {
    // 25 million candidates are the limit.
    const std::vector<std::string> large{"--pair", "512x224x256", "--rounds", "1", "--json", "-"};
    std::vector<std::string> named = large;
    named.insert(named.end(), {"--contestant", "naive/census"});
    EXPECT_EQ(nlohmann::json::parse(run(DISPARITY_BENCH, named).out).size(), 2U);
    const Outcome all = run(DISPARITY_BENCH, large);
    ASSERT_EQ(all.exit_code, 0) << all.err;
    EXPECT_THAT(all.out, AllOf(HasSubstr("opencv/hh"), Not(HasSubstr("naive"))));
}

using BenchFolderTest = FolderTest;

TEST_F(BenchFolderTest, JsonGoesToAFileBesideTheTables) {
    const Outcome outcome = bench({"--contestant", "cpu/sgm", "--json", path("out.json")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("cpu/sgm"));
    EXPECT_FALSE(nlohmann::json::parse(read_file(path("out.json"))).empty());
    const Outcome nowhere = bench({"--contestant", "cpu/sgm", "--json", path("missing/out.json")});
    EXPECT_EQ(nowhere.exit_code, 1);
    EXPECT_THAT(nowhere.err, HasSubstr("missing/out.json"));
    EXPECT_EQ(nowhere.out, "") << "refused before anything is measured";
}

TEST_F(BenchFolderTest, ScenesOfThePaperAreFoundOrSkipped) {
    const Pair pair = shifted_pair(96, 48, 5, 1);
    std::filesystem::create_directories(path("data/cones"));
    images::write_png(path("data/cones/left.png"), pair.left);
    images::write_png(path("data/cones/right.png"), pair.right);
    images::write_png(path("data/cones/disp_left.png"), cv::Mat(48, 96, CV_8UC1, cv::Scalar(5 * 4)));
    const Outcome outcome = run(DISPARITY_BENCH, {"--pair", "paper", "--contestant", "cpu/sad", "--no-roofline",
                                                  "--data", path("data"), "--rounds", "1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("cones 96x48, D 128"), Not(HasSubstr("teddy"))));
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("teddy is skipped"), HasSubstr("sawtooth is skipped")));
}

TEST_F(BenchFolderTest, CtrlCKeepsWhatThereIs) {
    std::vector<std::string> arguments{"--pair",   "64x48x16", "--contestant", "naive/sgm",
                                       "--rounds", "2",        "--no-roofline"};
    for (int i = 0; i < 1000; ++i) {
        arguments.insert(arguments.end(), {"--pair", "320x240x64"});
    }
    Program program(DISPARITY_BENCH, arguments);
    ASSERT_TRUE(eventually([&] { return program.said("rendered 64x48") || !program.running(); }));
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("naive/sgm"));
    EXPECT_THAT(outcome.err, HasSubstr("stopped by Ctrl-C"));
}

TEST(BenchTest, WrongInputIsOneLine) {
    const std::vector<std::pair<std::vector<std::string>, const char*>> cases{
        {{"--pair", "houses"}, "houses"},
        {{"--pair", "64x48x17"}, "64x48x17"},
        {{"--pair", "64x48x16x2"}, "64x48x16x2"},
        {{"--pair", "8x48x16"}, "8x48x16"},
        {{"--contestant", "gpu"}, "gpu"},
        {{"--contestant", "cuda/bm"}, "cuda/sgm"},
        {{"--isa", "MMX"}, "MMX"},
        {{"--threads", "0"}, "256"},
        {{"--threads", "two"}, "two"},
        {{"--rounds", "0"}, "100000"},
        {{"--seconds", "-1"}, "--seconds"},
        {{"--data", "/missing-folder"}, "folder"},
        {{"--disparities", "40"}, "multiple of 16"},
        {{"--sizzle"}, "--sizzle"},
    };
    for (const auto& [arguments, says] : cases) {
        const Outcome outcome = run(DISPARITY_BENCH, arguments);
        EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
        EXPECT_THAT(outcome.err, AllOf(StartsWith("disparity-bench: error: "), HasSubstr(says)));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }
}

TEST(BenchTest, HelpHasAnExample) {
    const Outcome outcome = run(DISPARITY_BENCH, {"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("Example: disparity-bench --pair"));
}

}  // namespace
}  // namespace disparityd::test
