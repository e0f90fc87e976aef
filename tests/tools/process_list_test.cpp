// SPDX-License-Identifier: Apache-2.0
//
// `process` over several sources: where each goes, shards, what fails, and when trying again may help.
#include <algorithm>
#include <csignal>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class ProcessListTest : public FolderTest {
protected:
    Outcome process(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"process", "--disparities", "16"});
        return run(DISPARITYCTL, arguments);
    }

    /// A folder of pairs and two recordings of one name, of 1, 2 and 3 frames.
    void make_sources() {
        make_kitti_folder(path("drive"), 1, 64, 32);
        std::filesystem::create_directories(path("a"));
        std::filesystem::create_directories(path("b"));
        make_recording(path("a/walk.mkv"), 2, 64, 32);
        make_recording(path("b/walk.mkv"), 3, 80, 40);
    }

    std::vector<std::string> sources() const { return {path("drive") + "/", path("a/walk.mkv"), path("b/walk.mkv")}; }

    std::vector<std::string> folders_in(const std::string& name) const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path(name))) {
            names.push_back(entry.path().filename());
        }
        std::sort(names.begin(), names.end());
        return names;
    }
};

TEST_F(ProcessListTest, ShardsTogetherAreTheSingleRun) {
    make_sources();
    std::vector<std::string> words = sources();
    words.emplace_back("-o");
    std::vector<std::string> whole = words;
    whole.insert(whole.end(), {path("whole"), "--json"});
    const Outcome outcome = process(whole);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 6);
    EXPECT_EQ(summary["complete"], true);
    EXPECT_EQ(summary["sources"][1]["frames"], 2);
    EXPECT_THAT(folders_in("whole"), ElementsAre("a_walk.mkv", "b_walk.mkv", "drive"));
    for (const char* shard : {"0/2", "1/2"}) {
        std::vector<std::string> part = words;
        std::swap(part[0], part[1]);  // the order of the words does not matter
        part.insert(part.end(), {path("shards"), "--shard", shard});
        EXPECT_EQ(process(part).exit_code, 0) << shard;
        EXPECT_EQ(folders_in("shards").size(), shard[0] == '0' ? 2U : 3U);
    }
    for (const std::string& name : folders_in("whole")) {
        EXPECT_EQ(files_in(path("whole/" + name)), files_in(path("shards/" + name))) << name;
    }
    ASSERT_EQ(process({path("drive"), "-o", path("alone")}).exit_code, 0);
    EXPECT_EQ(files_in(path("alone")).at("000000.png"), files_in(path("whole/drive")).at("000000.png"));
}

TEST_F(ProcessListTest, RangesOfFramesTogetherAreTheSingleRun) {
    make_kitti_folder(path("drive"), 6, 64, 32);
    make_recording(path("walk.mkv"), 6, 64, 32);
    for (const std::string name : {"drive", "walk.mkv"}) {
        const auto range = [&](const std::string& folder, std::vector<std::string> more) {
            more.insert(more.begin(),
                        {path(name), "-o", path(name + folder), "--pfm", "--no-trust", "--no-adaptive-noise"});
            const Outcome outcome = process(more);
            ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        };
        range("whole", {});
        std::map<std::string, std::string> together;
        auto frames = nlohmann::json::array();
        const std::vector<std::vector<std::string>> ranges{
            {"--frames", "2"}, {"--first", "2", "--frames", "3"}, {"--first", "5", "--frames", "9"}};
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            const std::string folder = "part" + std::to_string(i);
            range(folder, ranges[i]);
            together.merge(files_in(path(name + folder)));
            const auto manifest = nlohmann::json::parse(read_file(path(name + folder + "/manifest.json")));
            for (const auto& frame : manifest["frames"]) {
                frames.push_back(frame);
            }
        }
        auto whole = files_in(path(name + "whole"));
        EXPECT_EQ(frames, nlohmann::json::parse(whole["manifest.json"])["frames"]) << name;
        whole.erase("manifest.json");
        together.erase("manifest.json");
        whole.erase("geometry.json");  // counts the frames of its run
        together.erase("geometry.json");
        EXPECT_EQ(together, whole) << name;
    }
    const auto refused = [&](std::vector<std::string> more, const std::string& line) {
        more.insert(more.begin(), {path("walk.mkv"), "-o", path("refused"), "--first"});
        const Outcome outcome = process(more);
        EXPECT_EQ(outcome.exit_code, 2) << line;
        EXPECT_THAT(outcome.err, HasSubstr(line));
        EXPECT_FALSE(std::filesystem::exists(path("refused")));
    };
    refused({"1"}, "depends on the frames before (trust, adaptive-noise)");
    refused({"1", "--no-trust", "--no-adaptive-noise", "--temporal"}, "(temporal)");
    refused({"6", "--no-trust", "--no-adaptive-noise"}, "--first: found 6, allowed: 0 .. 5");
}

TEST_F(ProcessListTest, ATerminalShowsHowLongTheRestTakes) {
    const std::string terminal = "/usr/bin/script", in = "'scene:vga?frames=40&seed=";
    if (!std::filesystem::exists(terminal)) {
        GTEST_SKIP() << terminal << " is not installed";
    }
    const Outcome outcome =
        run(terminal, {"-qec", DISPARITYCTL " process " + in + "1' " + in + "2' -o " + path("out"), "/dev/null"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
    EXPECT_THAT(outcome.out,
                testing::ContainsRegex("source 2/2, frames \\[[#.]+\\] [0-9]+/40  [0-9.]+ frames/s, [0-9.]+ "
                                       "(s|min) left"));
}

TEST_F(ProcessListTest, AListHasASourceALine) {
    make_sources();
    write_text(path("list"), path("a/walk.mkv") + "\n\n" + path("b/walk.mkv"));
    const Outcome outcome = process({path("drive"), "--list", path("list"), "-o", path("out")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(folders_in("out"), ElementsAre("a_walk.mkv", "b_walk.mkv", "drive"));
    write_text(path("list"), "\n");
    for (const char* const list : {"list", "absent", "a"}) {
        const Outcome refused = process({"--list", path(list), "-o", path("none")});
        EXPECT_EQ(refused.exit_code, 2) << list;
        EXPECT_THAT(refused.err, HasSubstr(path(list))) << list;
    }
    EXPECT_THAT(process({"-o", path("none")}).err, HasSubstr("SOURCE: found none, allowed: at least one"));
}

TEST_F(ProcessListTest, APlanTellsFramesAndHowLongShardsTake) {
    make_sources();
    const std::string endless = "scene:vga?width=64&height=32", absent = path("absent.mkv");
    std::vector<std::string> words = sources();
    words.insert(words.end(), {"--plan", "--json"});
    const Outcome outcome = process(words);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto plan = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(plan["frames"], 6);
    // The whole was measured, as it is so short: a shard takes its share of the pixels.
    const double measured = plan["measured"]["seconds"].get<double>();
    EXPECT_EQ(plan["measured"]["frames"], 6);
    ASSERT_EQ(plan["shards"].size(), 3U);
    constexpr double pixels[] = {2 * 64 * 32, 3 * 80 * 40, 1 * 64 * 32};  // in the order of their names
    constexpr double all = pixels[0] + pixels[1] + pixels[2];
    EXPECT_NEAR(plan["shards"][0]["longest_seconds"].get<double>(), measured, 1e-6);
    EXPECT_NEAR(plan["shards"][1]["longest_seconds"].get<double>(), measured * pixels[1] / all, 1e-6);
    EXPECT_EQ(plan["shards"][2]["shards"], 3);
    words = {path("drive"), endless, absent, "--plan"};
    const Outcome partly = process(words);
    EXPECT_EQ(partly.exit_code, 1);
    EXPECT_THAT(partly.err, HasSubstr(absent));
    EXPECT_THAT(partly.out,
                AllOf(HasSubstr("2 sources, 1 frame\nnot in it, as their length is not known: 1 source\n  " + endless +
                                "\nmeasured on this machine: 13 frames of 2 sources in "),
                      HasSubstr("shards  minutes of the longest\n1  ")));
    EXPECT_EQ(process({path("drive")}).exit_code, 2) << "no folder to fill";
    EXPECT_THAT(folders_in(""), ElementsAre("a", "b", "drive"));
}

TEST_F(ProcessListTest, ASourceThatFailsEndsTheRunUnlessItGoesOn) {
    make_sources();
    std::filesystem::resize_file(path("a/walk.mkv"), std::filesystem::file_size(path("a/walk.mkv")) * 3 / 4);
    const Outcome stopped = process({path("a/walk.mkv"), path("drive"), "-o", path("stopped")});
    EXPECT_EQ(stopped.exit_code, 1);
    EXPECT_THAT(stopped.err, AllOf(HasSubstr(path("a/walk.mkv")), HasSubstr("1 source of 2 failed, as told above"),
                                   HasSubstr("1 was not begun; --keep-going")));
    EXPECT_FALSE(std::filesystem::exists(path("stopped/drive")));

    const Outcome outcome =
        process({path("a/walk.mkv"), path("nothing.mkv"), path("drive"), "-o", path("out"), "--keep-going", "--json"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("nothing.mkv"), HasSubstr("2 sources of 3 failed, as told above\n")));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["sources_done"], 1);
    EXPECT_EQ(summary["sources_failed"], 2);
    EXPECT_EQ(summary["sources_left"], 0);
    EXPECT_EQ(summary["complete"], false);
    EXPECT_THAT(summary["sources"][1]["error"].get<std::string>(), HasSubstr("nothing.mkv"));
    EXPECT_TRUE(std::filesystem::exists(path("out/drive/000000.png")));
}

TEST_F(ProcessListTest, WhatMaySucceedLaterIsExitStatus75) {
    const std::string endless = "scene:vga?width=160&height=120&frames=100000&loop=32";
    const Outcome full = process({endless, "-o", path("full"), "--scan", "/dev/full", "--force"});
    EXPECT_EQ(full.exit_code, 75);
    EXPECT_THAT(full.err, HasSubstr("/dev/full: cannot be written: No space left on device"));

    make_kitti_folder(path("drive"), 1, 64, 32);
    Program program(DISPARITYCTL, {"process", endless, path("drive"), "-o", path("out"), "--keep-going"});
    ASSERT_TRUE(eventually([&] {
        if (!program.running()) {
            return true;
        }
        const auto folders = std::filesystem::exists(path("out")) ? folders_in("out") : std::vector<std::string>();
        return !folders.empty() && std::filesystem::exists(path("out") + '/' + folders.front() + "/000000.png");
    }));
    program.send(SIGTERM);
    program.send(SIGTERM);  // as a scheduler does: once to the program, once to its group
    const Outcome ended = program.wait();
    EXPECT_EQ(ended.exit_code, 75) << ended.err;
    EXPECT_THAT(ended.err,
                AllOf(HasSubstr("note: stopped by SIGTERM"), HasSubstr("1 was not begun; --resume goes on")));
    EXPECT_FALSE(std::filesystem::exists(path("out/drive"))) << "it is not begun";
}

TEST_F(ProcessListTest, WhatIsNotAllowedIsOneLine) {
    make_sources();
    const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
        {{path("drive"), path("drive")}, "named twice"},
        {{path("drive"), path("a/walk.mkv"), "--shard", "2/2"}, "--shard: found '2/2', allowed: I/N"},
        {{path("drive"), path("a/walk.mkv"), "--shard", "1"}, "--shard: found '1'"},
        {{path("drive"), path("a/walk.mkv"), "--shard", "0/2x"}, "--shard: found '0/2x'"},
        {{path("drive"), path("a/walk.mkv"), "--shard", "-1/2"}, "--shard: found '-1/2'"},
        {{path("drive"), path("a/walk.mkv"), "--scan", path("scan.csv")}, "a name without a folder"},
        {{path("drive"), path("a/walk.mkv"), "--size", "640", "--keep-going"}, "--size"},
        {{path("a/walk.mkv"), path("a/../a/walk.mkv")}, "both would fill"},
    };
    for (auto [arguments, text] : wrong) {
        arguments.insert(arguments.end(), {"-o", path("out")});
        const Outcome outcome = process(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << text;
        EXPECT_THAT(outcome.err, HasSubstr(text));
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(path("out"))) << text;
    }
    const Outcome none = process({path("drive"), path("a/walk.mkv"), "-o", path("out"), "--shard", "2/3"});
    EXPECT_EQ(none.exit_code, 0);
    EXPECT_THAT(none.err, HasSubstr("none of the 2 sources belongs to it"));
    std::filesystem::create_directories(path("out/walk"));
    write_text(path("out/walk/mine.txt"), "keep");
    const Outcome full = process({path("drive"), path("a/walk.mkv"), "-o", path("out")});
    EXPECT_EQ(full.exit_code, 2);
    EXPECT_THAT(full.err, HasSubstr("out/walk: is not empty"));
    EXPECT_FALSE(std::filesystem::exists(path("out/drive"))) << "refused before any work";
}

}  // namespace
}  // namespace disparityd::test
