// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Key;

Outcome process(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "process");
    return run(DISPARITYCTL, arguments);
}

/// How many frames times.csv tells of.
std::size_t timed_frames(const std::string& folder) {
    const std::string csv = read_file(folder + "/times.csv");
    return static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')) - 1;
}

using ProcessTest = FolderTest;

TEST_F(ProcessTest, FolderOfPairsBecomesDisparity) {
    make_kitti_folder(path("in"), 3, 96, 48);
    const Outcome outcome = process({path("in"), "-o", path("out"), "--disparities", "16", "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 3);
    EXPECT_EQ(summary["complete"], true);
    EXPECT_EQ(summary["sources_done"], 1) << "as of a list";
    EXPECT_EQ(summary["sources_left"], 0);

    const auto files = files_in(path("out"));
    EXPECT_EQ(files.size(), 5U) << "three pictures, geometry.json and manifest.json";
    EXPECT_EQ(timed_frames(path("out")), 3U);
    for (int i = 0; i < 3; ++i) {
        const auto map = images::read_disparity_png(path("out/00000" + std::to_string(i) + ".png"));
        ASSERT_EQ(map.width, 96);
        int right = 0;
        for (int x = 32; x < 88; ++x) {
            right += std::abs(map.at(x, 24) - static_cast<float>(3 + i)) < 0.25F ? 1 : 0;
        }
        EXPECT_GT(right, 50) << "frame " << i;
    }
    const auto geometry = nlohmann::json::parse(files.at("geometry.json"));
    EXPECT_EQ(geometry["rectified"]["width"], 96);
    EXPECT_EQ(geometry["match"]["disparities"], 16);
    EXPECT_EQ(geometry["match"]["method"], "sgm");
}

TEST_F(ProcessTest, SameInputSameBytesWhateverTheWorkers) {
    make_recording(path("in.mkv"), 6, 96, 64);
    const auto pictures = [&](const std::string& name, const std::string& workers) {
        const Outcome outcome = process({path("in.mkv"), "-o", path(name), "--disparities", "32", "--colour", "--pfm",
                                         "--interpolate", "--workers", workers});
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return files_in(path(name));
    };
    const auto first = pictures("one", "1");
    EXPECT_EQ(first.size(), 6U * 3 + 2);
    EXPECT_EQ(first, pictures("again", "1"));
    EXPECT_EQ(first, pictures("two", "2"));
    EXPECT_EQ(first, pictures("four", "4"));
}

TEST_F(ProcessTest, EveryMethodAndBackEndGivesFrames) {
    make_recording(path("in.mkv"), 1, 64, 32);
    for (const char* method : {"sad", "census", "sgm"}) {
        const auto pictures = [&](const std::string& backend) {
            const std::string out = path(std::string(method) + backend);
            EXPECT_EQ(process({path("in.mkv"), "-o", out, "--method", method, "--backend", backend}).exit_code, 0);
            return files_in(out)["000000.png"];
        };
        const std::string reference = pictures("reference");
        EXPECT_FALSE(reference.empty()) << method;
        EXPECT_EQ(reference, pictures("cpu")) << method;
    }
}

TEST_F(ProcessTest, RangesThatAPngCannotHoldBecomePfm) {
    make_kitti_folder(path("in"), 1, 64, 32);
    const Outcome outcome = process({path("in"), "-o", path("out"), "--d-min", "-16", "--disparities", "32"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("PFM"));
    const auto files = files_in(path("out"));
    EXPECT_THAT(files, Contains(Key("000000.pfm")));
    EXPECT_THAT(files, testing::Not(Contains(Key("000000.png"))));
}

TEST_F(ProcessTest, SizeAndRegionAreIndependentOfTheCapture) {
    make_kitti_folder(path("in"), 1, 96, 48);
    const Outcome outcome =
        process({path("in"), "-o", path("out"), "--disparities", "16", "--region", "8,4,64,32", "--frames", "1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto map = images::read_disparity_png(path("out/000000.png"));
    EXPECT_EQ(map.width, 64);
    EXPECT_EQ(map.height, 32);
}

TEST_F(ProcessTest, FramesLimitsTheNumber) {
    make_recording(path("in.mkv"), 5, 64, 32);
    EXPECT_EQ(process({path("in.mkv"), "-o", path("out"), "--frames", "2"}).exit_code, 0);
    EXPECT_EQ(timed_frames(path("out")), 2U);
}

TEST_F(ProcessTest, AFolderWithFilesIsLeftAlone) {
    make_kitti_folder(path("in"), 1, 64, 32);
    std::filesystem::create_directory(path("out"));
    write_text(path("out/000007.png"), "somebody's, such as the input");
    write_text(path("out/mine.txt"), "keep");
    EXPECT_EQ(process({path("in"), "-o", path("out")}).exit_code, 2);
    const Outcome not_ours = process({path("in"), "-o", path("out"), "--force"});
    EXPECT_EQ(not_ours.exit_code, 2);
    EXPECT_THAT(not_ours.err, HasSubstr("allowed: a new or empty folder"));
    EXPECT_EQ(files_in(path("out")).size(), 2U);

    write_text(path("out/geometry.json"), "{\"crs\": \"EPSG:4326\"}");
    EXPECT_EQ(process({path("in"), "-o", path("out"), "--force"}).exit_code, 2) << "somebody's geometry.json";
    for (const char* const unknown : {"{\"crs\": 1}", "{\"match\": {}, \"files\": []}"}) {
        write_text(path("out/geometry.json"), unknown);
        const Outcome resumed = process({path("in"), "-o", path("out"), "--resume"});
        EXPECT_EQ(resumed.exit_code, 2);
        EXPECT_THAT(resumed.err, HasSubstr("no manifest tells what was begun in it"));
        EXPECT_EQ(files_in(path("out")).size(), 3U);
    }
    EXPECT_THAT(process({path("in"), "-o", path("out")}).err, HasSubstr("--force"));
    EXPECT_EQ(process({path("in"), "-o", path("out"), "--force"}).exit_code, 0);
    const auto files = files_in(path("out"));
    EXPECT_EQ(files.at("mine.txt"), "keep");
    EXPECT_THAT(files, Contains(Key("000007.png"))) << "no times.csv names it";
    EXPECT_EQ(process({path("in"), "-o", path("in/image_0/000000.png")}).exit_code, 2) << "a file is no folder";
}

TEST_F(ProcessTest, CtrlCLeavesWholeFiles) {
    make_recording(path("in.mkv"), 400, 160, 120);
    Program program(DISPARITYCTL, {"process", path("in.mkv"), "-o", path("out"), "--disparities", "64", "--backend",
                                   "reference", "--workers", "1"});
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(path("out/000001.png")) || !program.running(); }));
    program.send(SIGINT);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("note: stopped by Ctrl-C"));
    EXPECT_THAT(outcome.err, testing::Not(HasSubstr("error")));
    auto files = files_in(path("out"));
    EXPECT_EQ(files.erase(".manifest.json.part"), 1U) << "--resume goes by it";
    ASSERT_LT(files.size(), 400U);
    ASSERT_GE(files.size(), 3U);
    for (const auto& [name, bytes] : files) {
        if (name != "geometry.json") {
            EXPECT_EQ(images::read_disparity_png(path("out/" + name)).height, 120) << name;
        }
    }
    EXPECT_EQ(timed_frames(path("out")), files.size() - 1);
}

TEST_F(ProcessTest, ASignalBeforeTheFirstFrameIsExitStatus75) {
    make_recording(path("in.mkv"), 2, 64, 32);
    ASSERT_EQ(mkfifo(path("calibration.yml").c_str(), 0600), 0);
    Program program(DISPARITYCTL,
                    {"process", path("in.mkv"), "-o", path("out"), "--calibration", path("calibration.yml")});
    // It can be opened once the program reads it, and holds the program there until it is closed.
    int writer = -1;
    ASSERT_TRUE(eventually([&] {
        writer = open(path("calibration.yml").c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        return writer >= 0 || !program.running();
    }));
    program.send(SIGTERM);
    close(writer);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 75) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("note: stopped by SIGTERM"));
}

TEST_F(ProcessTest, TruncatedRecordingGivesWhatIsThere) {
    make_recording(path("in.mkv"), 30, 128, 64);
    std::filesystem::resize_file(path("in.mkv"), std::filesystem::file_size(path("in.mkv")) / 2);
    const Outcome outcome = process({path("in.mkv"), "-o", path("out"), "--disparities", "16", "--json"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("in.mkv"));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["complete"], false);
    EXPECT_EQ(summary["frames"], timed_frames(path("out")));
    EXPECT_GT(summary["frames"], 5);
    EXPECT_LT(summary["frames"], 30);
}

}  // namespace
}  // namespace disparityd::test
