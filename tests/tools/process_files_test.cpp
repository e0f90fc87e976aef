// SPDX-License-Identifier: Apache-2.0
//
// Which files `process` makes of which input, what it leaves out, and that nobody else writes into them.
#include <csignal>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/tools/made_input.h"
#include "tests/tools/run_program.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class ProcessFilesTest : public FolderTest {
protected:
    Outcome process(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"process", "-o", path("out"), "--disparities", "16"});
        return run(DISPARITYCTL, arguments);
    }

    /// A pair in KITTI's folders.
    void make_pair(const std::string& name, int shift, cv::Size size = {64, 32}) {
        std::filesystem::create_directories(path("in/image_2"));
        std::filesystem::create_directories(path("in/image_3"));
        const Pair pair = shifted_pair(size.width, size.height, shift, 1);
        images::write_png(path("picture.png"), pair.left);
        std::filesystem::rename(path("picture.png"), path("in/image_2/" + name));
        images::write_png(path("picture.png"), pair.right);
        std::filesystem::rename(path("picture.png"), path("in/image_3/" + name));
    }

    std::vector<std::string> names_in_output() const {
        std::vector<std::string> names;
        for (const auto& [name, bytes] : files_in(path("out"))) {
            names.push_back(name);
        }
        return names;
    }

    /// Frame, output and input of each line of times.csv, quotation marks and all.
    std::vector<std::string> times() const {
        std::istringstream csv(read_file(path("out/times.csv")));
        std::vector<std::string> lines;
        std::ptrdiff_t further = 0;  // columns behind these three, which hold numbers
        for (std::string line; std::getline(csv, line); lines.push_back(line)) {
            if (lines.empty()) {
                further = std::count(line.begin(), line.end(), ',') - 2;
            }
            for (std::ptrdiff_t i = 0; i < further; ++i) {
                line.resize(line.rfind(','));
            }
        }
        return lines;
    }

    void expect_shift(const std::string& name, int shift) const {
        const auto map = images::read_disparity_png(path("out/" + name));
        int right = 0;
        for (int x = 20; x < 60; ++x) {
            right += std::abs(map.at(x, 16) - static_cast<float>(shift)) < 0.25F ? 1 : 0;
        }
        EXPECT_GT(right, 35) << name;
    }
};

TEST_F(ProcessFilesTest, OutputsHaveTheNamesOfTheInputs) {
    make_pair("000012_10.png", 3);
    make_pair("000012_11.png", 5);
    ASSERT_EQ(process({path("in")}).exit_code, 0);
    EXPECT_THAT(names_in_output(), ElementsAre("000012_10.png", "000012_11.png", "geometry.json", "manifest.json"));
    EXPECT_THAT(times(), ElementsAre("frame,output,input", "0,000012_10,000012_10.png", "1,000012_11,000012_11.png"));
    expect_shift("000012_10.png", 3);
    expect_shift("000012_11.png", 5);
    const auto geometry = nlohmann::json::parse(files_in(path("out")).at("geometry.json"));
    EXPECT_EQ(geometry["files"][0]["name"], "OUTPUT.png");
}

TEST_F(ProcessFilesTest, InputsOfOneStemGetNamesOfTheirOwn) {
    make_pair("a.bmp", 3);
    make_pair("a.png", 4);
    make_pair("a_colour.png", 5);
    ASSERT_EQ(process({path("in"), "--colour"}).exit_code, 0);
    EXPECT_THAT(times(), ElementsAre("frame,output,input", "0,a,a.bmp", "1,a-2,a.png", "2,a_colour-2,a_colour.png"));
    EXPECT_THAT(names_in_output(),
                ElementsAre("a-2.png", "a-2_colour.png", "a.png", "a_colour-2.png", "a_colour-2_colour.png",
                            "a_colour.png", "geometry.json", "manifest.json"));
    expect_shift("a.png", 3);
    expect_shift("a-2.png", 4);
    expect_shift("a_colour-2.png", 5);
}

TEST_F(ProcessFilesTest, UnusualNamesAreQuotedAndRemovedAgain) {
    const std::string endless(240, 'x');
    make_pair("a, \"b\".png", 3);
    make_pair("c\n\x1b[2J.png", 3);
    make_pair(endless + ".png", 3);
    ASSERT_EQ(process({path("in")}).exit_code, 0);
    EXPECT_THAT(times(), ElementsAre("frame,output,input", "0,\"a, \"\"b\"\"\",\"a, \"\"b\"\".png\"",
                                     "1,c__[2J,c??[2J.png", "2," + endless.substr(40) + ',' + endless + ".png"));
    EXPECT_THAT(names_in_output(), ElementsAre("a, \"b\".png", "c__[2J.png", "geometry.json", "manifest.json",
                                               endless.substr(40) + ".png"));

    write_text(path("out/mine.png"), "keep");
    write_text(path("out/b.png"), "keep, it is no output");
    make_kitti_folder(path("other"), 1, 64, 32);
    EXPECT_EQ(process({path("other"), "--force"}).exit_code, 0);
    EXPECT_THAT(names_in_output(), ElementsAre("000000.png", "b.png", "geometry.json", "manifest.json", "mine.png"));
}

TEST_F(ProcessFilesTest, VideosKeepNumbersAndNameThemselves) {
    make_recording(path("in, 1.mkv"), 2, 64, 32);
    ASSERT_EQ(process({path("in, 1.mkv")}).exit_code, 0);
    EXPECT_THAT(read_file(path("out/times.csv")),
                AllOf(HasSubstr("\n0,000000,\"in, 1.mkv\",0,"), HasSubstr("\n1,000001,\"in, 1.mkv\",1,")));
}

TEST_F(ProcessFilesTest, TwoNamesAreAPair) {
    const Pair pair = shifted_pair(64, 32, 4, 1);
    images::write_png(path("l.png"), pair.left);
    images::write_png(path("r.png"), pair.right);
    const Outcome outcome = process({path("l.png"), path("r.png")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no calibration is known"));
    expect_shift("l.png", 4);
    const std::string first = read_file(path("out/l.png"));
    ASSERT_EQ(process({path("l.png") + "," + path("r.png"), "--force"}).exit_code, 0);
    EXPECT_EQ(read_file(path("out/l.png")), first);
}

TEST_F(ProcessFilesTest, SixteenBitsAreConvertedAndTold) {
    const Pair pair = shifted_pair(64, 32, 4, 1);
    cv::Mat left, right;
    pair.left.convertTo(left, CV_16U, 16);  // 12 bits
    pair.right.convertTo(right, CV_16U, 16);
    images::write_png(path("l.png"), left);
    images::write_png(path("r.png"), right);
    const Outcome outcome = process({path("l.png") + "," + path("r.png") + "?bits=12"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("note"), HasSubstr("value / 16 is used"), HasSubstr("?bits=12")));
    const std::string deep = read_file(path("out/l.png"));
    images::write_png(path("l.png"), pair.left);
    images::write_png(path("r.png"), pair.right);
    ASSERT_EQ(process({path("l.png"), path("r.png"), "--force"}).exit_code, 0);
    EXPECT_EQ(read_file(path("out/l.png")), deep) << "the same 8 bits";
}

TEST_F(ProcessFilesTest, KeepGoingLeavesDamagedImagesOut) {
    make_kitti_folder(path("in"), 4, 64, 32);
    std::filesystem::resize_file(path("in/image_0/000001.png"), 100);
    std::filesystem::resize_file(path("in/image_1/000002.png"), 10);
    const Outcome stopped = process({path("in")});
    EXPECT_EQ(stopped.exit_code, 1);
    EXPECT_THAT(stopped.err, AllOf(HasSubstr("000001.png"), HasSubstr("before that")));

    const Outcome outcome = process({path("in"), "--keep-going", "--force", "--json"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("left out: " + path("in/image_0/000001.png")),
                                   HasSubstr("left out: " + path("in/image_1/000002.png")),
                                   HasSubstr("2 frames were left out, as noted above; in "), HasSubstr(": 2 frames")));
    EXPECT_THAT(times(), ElementsAre("frame,output,input", "0,000000,000000.png", "1,000003,000003.png"));
    EXPECT_THAT(names_in_output(), ElementsAre("000000.png", "000003.png", "geometry.json", "manifest.json"));
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 2);
    EXPECT_EQ(summary["complete"], false);
    ASSERT_EQ(summary["left_out"].size(), 2U);
    EXPECT_THAT(summary["left_out"][0].get<std::string>(), HasSubstr("000001.png"));

    make_kitti_folder(path("in"), 4, 64, 32);
    const Outcome whole = process({path("in"), "--keep-going", "--force"});
    EXPECT_EQ(whole.exit_code, 0) << whole.err;
    EXPECT_EQ(whole.err, "");
}

// As in KITTI 2012 and 2015, whose calibrations of each frame are of its size, and of its day.
TEST_F(ProcessFilesTest, EachPairIsMatchedAtItsOwnSizeWithItsOwnCalibration) {
    const std::vector<cv::Size> sizes{{64, 32}, {80, 40}, {80, 40}, {64, 32}, {64, 32}};
    const std::vector<int> f{64, 80, 80, 64, 70};
    std::filesystem::create_directories(path("in/calib_cam_to_cam"));
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const std::string name = "00000" + std::to_string(i);
        make_pair(name + "_10.png", 3 + static_cast<int>(i), sizes[i]);
        const std::string centre = " 0 " + std::to_string(sizes[i].width / 2) + " ";
        const std::string row = " 0 " + std::to_string(f[i]) + " 16 0 0 0 1 0";
        write_text(path("in/calib_cam_to_cam/" + name + ".txt"),
                   "S_rect_02: " + std::to_string(sizes[i].width) + " " + std::to_string(sizes[i].height) +
                       "\nP_rect_02: " + std::to_string(f[i]) + centre + "0" + row +
                       "\nP_rect_03: " + std::to_string(f[i]) + centre + "-12" + row + "\n");
    }
    const Outcome outcome = process({path("in")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("several sizes"), HasSubstr("4 parts")));
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("64x32: nothing nearer"), HasSubstr("80x40: nothing nearer"), HasSubstr("5 frames")));
    EXPECT_THAT(times(),
                ElementsAre("frame,output,input", "0,000000_10,000000_10.png", "1,000001_10,000001_10.png",
                            "2,000002_10,000002_10.png", "3,000003_10,000003_10.png", "4,000004_10,000004_10.png"));
    const auto geometry = nlohmann::json::parse(read_file(path("out/geometry.json")));
    EXPECT_FALSE(geometry.contains("rectified")) << "of which size would it be?";
    ASSERT_EQ(geometry["parts"].size(), 4U);
    EXPECT_EQ(geometry["parts"][1]["from_frame"], 1);
    EXPECT_EQ(geometry["parts"][1]["rectified"]["width"], 80);
    EXPECT_EQ(geometry["parts"][1]["rectified"]["f"], 80.0);
    EXPECT_EQ(geometry["parts"][2]["from_frame"], 3);
    EXPECT_EQ(geometry["parts"][2]["rectified"]["f"], 64.0);
    EXPECT_EQ(geometry["parts"][3]["from_frame"], 4);
    EXPECT_EQ(geometry["parts"][3]["rectified"]["f"], 70.0);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const std::string name = "00000" + std::to_string(i) + "_10.png";
        const Outcome alone = run(DISPARITYCTL, {"process", path("in/image_2/" + name), path("in/image_3/" + name),
                                                 "-o", path("alone"), "--disparities", "16", "--force"});
        ASSERT_EQ(alone.exit_code, 0) << alone.err;
        EXPECT_EQ(read_file(path("alone/" + name)), read_file(path("out/" + name)));
    }

    // One calibration for all leaves the sizes alone.
    const Outcome named =
        process({path("in"), "--calibration", path("in/calib_cam_to_cam/000000.txt"), "--frames", "1", "--force"});
    ASSERT_EQ(named.exit_code, 0) << named.err;
    EXPECT_THAT(named.err, HasSubstr("3 parts"));

    EXPECT_EQ(process({path("in"), "--frames", "2", "--force"}).exit_code, 0);
    EXPECT_THAT(times(), SizeIs(3));
    const Outcome refused = process({path("in"), "--self-calibrate", "--force"});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("several sizes or calibrations, allowed: those of one camera and size"));
    const Outcome unordered = process({path("in"), "--temporal", "--force"});
    EXPECT_EQ(unordered.exit_code, 2);
    EXPECT_THAT(unordered.err, HasSubstr("several sizes or calibrations, allowed: frames of one camera"));
}

TEST_F(ProcessFilesTest, MeansOverTimeAreTheSameInEveryRun) {
    const std::string scene = "scene:vga@30?width=160&height=96&frames=6&loop=32";
    const auto frame = [&](const std::string& folder, const std::string& name,
                           const std::vector<std::string>& options) {
        std::vector<std::string> words{"process", scene, "-o", path(folder), "--force"};
        words.insert(words.end(), options.begin(), options.end());
        const Outcome outcome = run(DISPARITYCTL, words);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return read_file(path(folder + "/" + name));
    };
    const std::string last = frame("one", "000005.png", {"--temporal", "--workers", "1"});
    EXPECT_EQ(frame("again", "000005.png", {"--temporal", "--workers", "1"}), last);
    EXPECT_EQ(frame("three", "000005.png", {"--temporal", "--workers", "3"}), last);
    EXPECT_NE(frame("without", "000005.png", {}), last);
    EXPECT_EQ(read_file(path("without/000000.png")), read_file(path("one/000000.png")));
}

TEST_F(ProcessFilesTest, OneProcessAtATimeFillsAFolder) {
    make_recording(path("in.mkv"), 400, 160, 120);
    make_kitti_folder(path("other"), 1, 64, 32);
    Program first(DISPARITYCTL, {"process", path("in.mkv"), "-o", path("out"), "--disparities", "64", "--backend",
                                 "reference", "--workers", "1"});
    ASSERT_TRUE(eventually([&] { return std::filesystem::exists(path("out/000000.png")) || !first.running(); }));
    first.send(SIGSTOP);
    const Outcome second = process({path("other"), "--force"});
    const bool refused_early = read_file(path("out/geometry.json")).find("other") == std::string::npos;
    first.send(SIGCONT);
    first.send(SIGINT);
    EXPECT_EQ(second.exit_code, 1) << second.err;
    EXPECT_THAT(second.err, AllOf(HasSubstr(path("out")), HasSubstr("another program is writing it")));
    EXPECT_TRUE(refused_early);
    EXPECT_EQ(first.wait().exit_code, 130);
    EXPECT_TRUE(std::filesystem::exists(path("out/000000.png")));
    EXPECT_EQ(process({path("other"), "--force"}).exit_code, 0) << "the lock ends with the process";
}

}  // namespace
}  // namespace disparityd::test
