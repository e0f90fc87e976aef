// SPDX-License-Identifier: Apache-2.0
//
// `process --split`: ranges of frames for the shards, and the whole that is joined of them.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class ProcessSplitTest : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        make_kitti_folder(path("drive"), 5, 64, 32);
        make_recording(path("walk.mkv"), 7, 80, 40);
    }

    std::vector<std::string> words(const std::string& folder, std::vector<std::string> more) const {
        const std::vector<std::string> all{"process", path("drive"), path("walk.mkv"),      scene,
                                           "-o",      path(folder),  "--disparities",       "16",
                                           "--pfm",   "--no-trust",  "--no-adaptive-noise", "--rectified"};
        more.insert(more.begin(), all.begin(), all.end());
        return more;
    }

    Outcome process(const std::string& folder, const std::vector<std::string>& more = {}) const {
        return run(DISPARITYCTL, words(folder, more));
    }

    Outcome shard(const std::string& folder, const std::string& which, std::vector<std::string> more = {}) const {
        more.insert(more.end(), {"--split", "--shard", which});
        return process(folder, more);
    }

    Outcome verify(const std::string& folder) const {
        return run(DISPARITYCTL, {"verify", path(folder), "--against", path("whole")});
    }

    /// Every file below a folder but times.csv, whose times differ.
    std::map<std::string, std::string> all_in(const std::string& folder) const {
        std::map<std::string, std::string> all;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path(folder))) {
            const std::string name = std::filesystem::relative(entry.path(), path(folder));
            if (entry.path().filename() != "times.csv") {
                all[name] = entry.is_directory() ? "folder" : read_file(entry.path());
            }
        }
        return all;
    }

    bool is_there(const std::string& name) const { return std::filesystem::exists(path(name)); }

    const std::string scene = "scene:vga?width=96&height=64&frames=2";
};

TEST_F(ProcessSplitTest, ShardsTogetherAreTheSingleRun) {
    ASSERT_EQ(process("whole").exit_code, 0);
    for (const char* const which : {"2/3", "0/3"}) {
        const Outcome outcome = shard("out", which, {"--workers", "1"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    EXPECT_TRUE(is_there("out/walk/range-0-of-3/000001.png"));
    EXPECT_TRUE(is_there("out/walk/range-2-of-3/000004.png")) << "frames have the names of the whole";
    EXPECT_EQ(verify("out").exit_code, 1);
    EXPECT_THAT(verify("out").out,
                HasSubstr("out/walk: not finished: there is no manifest.json, but 2 of 3 ranges of --split"));
    const Outcome last = shard("out", "1/3", {"--json"});
    ASSERT_EQ(last.exit_code, 0) << last.err;
    EXPECT_THAT(last.err, HasSubstr("out/walk: joined from 3 ranges, 7 frames\n"));
    EXPECT_THAT(last.err, HasSubstr("joined from 2 ranges, 2 frames\n")) << "of the scene a shard gets nothing";
    EXPECT_EQ(all_in("out"), all_in("whole"));
    const Outcome verified = verify("out");
    EXPECT_EQ(verified.exit_code, 0) << verified.out;
    EXPECT_THAT(shard("out", "1/3").err, HasSubstr("--resume to finish the earlier run in it, or --force"));
    const Outcome again = shard("out", "0/3", {"--resume", "--json"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(nlohmann::json::parse(again.out)["sources_done_before"], 3);
    EXPECT_EQ(process("out", {"--resume"}).exit_code, 0) << "it is as the single run has it";
    EXPECT_EQ(all_in("out"), all_in("whole"));
}

TEST_F(ProcessSplitTest, KilledAtAnyMomentAndResumedIsTheSingleRun) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(process("whole").exit_code, 0);
    const auto usual = std::chrono::steady_clock::now() - start;
    std::mt19937 random(std::random_device{}());
    int killed = 0;
    for (int i = 0; i < 6 || (killed == 0 && i < 60); ++i) {
        const double share = std::uniform_real_distribution<double>(0, 1)(random);
        Program program(DISPARITYCTL, words("out", {"--split", "--resume", "--shard", i % 2 == 0 ? "0/2" : "1/2"}));
        std::this_thread::sleep_for(std::chrono::duration_cast<std::chrono::nanoseconds>(usual) * share);
        program.send(SIGKILL);
        const Outcome ended = program.wait();
        ASSERT_TRUE(ended.exit_code == 0 || ended.exit_code == 128 + SIGKILL) << ended.err;
        killed += ended.exit_code == 0 ? 0 : 1;
    }
    for (const char* const which : {"0/2", "1/2"}) {
        const Outcome outcome = shard("out", which, {"--resume"});
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    EXPECT_EQ(all_in("out"), all_in("whole")) << "after " << killed << " kills";
    EXPECT_EQ(verify("out").exit_code, 0);
}

TEST_F(ProcessSplitTest, AJoinThatWasKilledGoesOn) {
    ASSERT_EQ(process("whole").exit_code, 0);
    ASSERT_EQ(shard("out", "0/2").exit_code, 0);
    // As it stands in the middle: some files are moved, the manifest is begun; and at the end, ranges are left.
    const std::string manifest = read_file(path("whole/walk/manifest.json"));
    std::filesystem::rename(path("out/walk/range-0-of-2/000001.png"), path("out/walk/000001.png"));
    write_text(path("out/walk/.manifest.json.part"), manifest.substr(0, manifest.find("\"frames\": [") + 11));
    const auto untouched = std::filesystem::last_write_time(path("out/walk/000001.png"));
    const Outcome first = shard("out", "0/2", {"--resume", "--json"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    EXPECT_EQ(nlohmann::json::parse(first.out)["sources_done_before"], 3) << "what was moved is not missing";
    ASSERT_EQ(shard("out", "1/2", {"--resume"}).exit_code, 0);
    EXPECT_EQ(std::filesystem::last_write_time(path("out/walk/000001.png")), untouched);
    EXPECT_EQ(all_in("out"), all_in("whole"));

    std::filesystem::create_directories(path("out/walk/range-0-of-2"));
    std::filesystem::copy_file(path("out/walk/manifest.json"), path("out/walk/range-0-of-2/manifest.json"));
    ASSERT_EQ(shard("out", "1/2", {"--resume"}).exit_code, 0);
    EXPECT_EQ(all_in("out"), all_in("whole"));
}

TEST_F(ProcessSplitTest, RangesThatDoNotBelongTogetherAreNotJoined) {
    const std::string calibration = path("calib.yaml");
    const auto range = [&](const std::string& which, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"process", path("walk.mkv"), "-o", path("out"), "--disparities", "16", "--no-trust",
                                   "--no-adaptive-noise", "--split", "--resume", "--shard", which});
        return run(DISPARITYCTL, more);
    };
    ASSERT_EQ(range("0/2").exit_code, 0);
    const Outcome other = range("1/2", {"--median", "5"});
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_THAT(other.err, AllOf(HasSubstr("out/range-1-of-2: does not belong to "),
                                 HasSubstr("parameters.match.median = 5, there 3")));
    EXPECT_FALSE(is_there("out/manifest.json"));
    std::string text = read_file(path("out/range-0-of-2/manifest.json"));
    text.replace(text.find("\"maps_sha256\":null"), 18, "\"maps_sha256\":\"00\"");
    write_text(path("out/range-0-of-2/manifest.json"), text);
    std::filesystem::remove_all(path("out/range-1-of-2"));
    EXPECT_THAT(range("1/2").err, HasSubstr("parts.0.maps_sha256 = null, there \"00\"")) << "other maps";
    EXPECT_EQ(range("1/4").exit_code, 2);
    EXPECT_THAT(range("1/4").err, AllOf(HasSubstr("out: holds range-"), HasSubstr("allowed with --shard 1/4: ranges "
                                                                                  "of 4 shards")));
    const Outcome whole =
        run(DISPARITYCTL, {"process", path("walk.mkv"), "-o", path("out"), "--disparities", "16", "--force"});
    EXPECT_EQ(whole.exit_code, 2);
    EXPECT_THAT(whole.err, HasSubstr("which --split has begun"));
}

// The manifest of a range is there a moment before its process lets go of the folder.
TEST_F(ProcessSplitTest, ShardsThatRunAtOnceAreTheSingleRun) {
    ASSERT_EQ(process("whole").exit_code, 0);
    std::vector<std::unique_ptr<Program>> shards;
    for (const char* const which : {"0/4", "1/4", "2/4", "3/4"}) {
        shards.push_back(std::make_unique<Program>(
            DISPARITYCTL, words("out", {"--split", "--shard", which, "--workers", "1", "--keep-going"})));
    }
    for (const auto& shard : shards) {
        const Outcome ended = shard->wait();
        EXPECT_EQ(ended.exit_code, 0) << ended.err;
    }
    EXPECT_EQ(all_in("out"), all_in("whole"));
    EXPECT_EQ(verify("out").exit_code, 0);
}

TEST_F(ProcessSplitTest, ASourceThatFailsKeepsNoOtherFromBeingDone) {
    for (const char* const which : {"0/2", "1/2"}) {
        const Outcome outcome =
            run(DISPARITYCTL, {"process", path("absent.mkv"), path("walk.mkv"), "-o", path("out"), "--disparities",
                               "16", "--no-trust", "--no-adaptive-noise", "--keep-going", "--split", "--shard", which});
        EXPECT_EQ(outcome.exit_code, 2) << "as without --split";
        EXPECT_THAT(outcome.err, HasSubstr("absent.mkv"));
    }
    EXPECT_TRUE(is_there("out/walk/manifest.json"));
}

TEST_F(ProcessSplitTest, ATableThatLostLinesIsNotJoined) {
    ASSERT_EQ(shard("out", "0/2").exit_code, 0);
    const std::string table = path("out/walk/range-0-of-2/times.csv");
    const std::string text = read_file(table);
    write_text(table, text.substr(0, text.rfind('\n', text.size() - 2) + 1));
    const Outcome last = shard("out", "1/2");
    EXPECT_EQ(last.exit_code, 1);
    EXPECT_THAT(last.err, HasSubstr("range-0-of-2/times.csv: is damaged: found 3 lines for 3 frames; remove "));
    EXPECT_TRUE(is_there("out/walk/range-0-of-2/000001.png")) << "nothing was moved";
}

TEST_F(ProcessSplitTest, WhatCannotBeCutIsRefusedByName) {
    const auto refused = [&](std::vector<std::string> more, const std::string& line) {
        more.insert(more.begin(), {"process", "-o", path("out"), "--disparities", "16"});
        const Outcome outcome = run(DISPARITYCTL, more);
        EXPECT_EQ(outcome.exit_code, 2) << line;
        EXPECT_THAT(outcome.err, HasSubstr(line));
        EXPECT_FALSE(is_there("out"));
    };
    const std::string walk = path("walk.mkv");
    for (const char* const which : {"0/2", "1/2"}) {
        refused({walk, "--split", "--shard", which},
                "--split: what is made of a frame depends on the frames before (trust, adaptive-noise)");
    }
    refused({walk, "--split"}, "--split: found no --shard");
    refused({walk, "--split", "--shard", "2/2"}, "--shard: found '2/2'");
    refused({walk, "--split", "--shard", "0/2", "--first", "1"}, "--first");
    refused({"scene:vga?width=64&height=32", "--split", "--shard", "0/2", "--no-trust", "--no-adaptive-noise"},
            "--split: how many frames scene:vga?width=64&height=32 has is not known");
    const Outcome nothing = shard("out", "0/9");
    EXPECT_EQ(nothing.exit_code, 0);
    EXPECT_THAT(nothing.err, HasSubstr("--shard 0/9: no frame of the 3 sources belongs to it"));
    EXPECT_FALSE(is_there("out"));
    write_text(path("drive/image_0/000003.png"), "damaged");
    const Outcome damaged = shard("out", "1/2", {"--keep-going"});
    EXPECT_EQ(damaged.exit_code, 1);
    EXPECT_THAT(damaged.err, HasSubstr("000003.png"));
    EXPECT_TRUE(is_there("out/walk/range-1-of-2/manifest.json")) << "the next source";
}

TEST_F(ProcessSplitTest, APlanDividesFrames) {
    const Outcome outcome = run(DISPARITYCTL, {"process", path("walk.mkv"), "--disparities", "16", "--no-trust",
                                               "--no-adaptive-noise", "--split", "--plan", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto plan = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(plan["shards"].size(), 3U) << "1, 2 and 4 of 7 frames";
    const double whole = plan["shards"][0]["longest_seconds"].get<double>();
    EXPECT_NEAR(plan["shards"][2]["longest_seconds"].get<double>(), whole / 4, 1e-9);
    EXPECT_THAT(run(DISPARITYCTL, {"process", path("walk.mkv"), "--split", "--plan"}).err, HasSubstr("(trust"));
}

}  // namespace
}  // namespace disparityd::test
