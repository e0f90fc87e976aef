// SPDX-License-Identifier: Apache-2.0
//
// What `process` tells beside its pictures: which distances it measures, which range a dataset asks for, and why a
// result is nearly empty.
#include <filesystem>

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

/// A rectified pair of random texture in Middlebury's layout, all of it at one disparity.
class ProcessToldTest : public FolderTest {
protected:
    void make_scene(int disparity, const std::string& calib_txt) {
        std::filesystem::create_directories(path("in"));
        const Pair pair = shifted_pair(width, height, disparity, 7);
        images::write_png(path("in/im0.png"), pair.left);
        images::write_png(path("in/im1.png"), pair.right);
        if (!calib_txt.empty()) {
            write_text(path("in/calib.txt"), calib_txt);
        }
    }

    Outcome process(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"process", "-o", path("out")});
        return run(DISPARITYCTL, arguments);
    }

    std::string told_;  ///< on standard error

    nlohmann::json geometry() const { return nlohmann::json::parse(read_file(path("out/geometry.json"))); }

    static constexpr int width = 320;
    static constexpr int height = 96;
};

std::string middlebury_calibration(const std::string& more) {
    return "cam0=[400 0 160; 0 400 48; 0 0 1]\ncam1=[400 0 160; 0 400 48; 0 0 1]\ndoffs=0\nbaseline=100\nwidth=320\n"
           "height=96\n" +
           more;
}

TEST_F(ProcessToldTest, LimitsOfDistanceRejectWhatLiesBeyondThem) {
    make_scene(20, middlebury_calibration(""));  // 2 m
    const auto measured = [this](std::vector<std::string> limits) {
        limits.insert(limits.end(), {path("in"), "--force", "--scan", path("scan.csv"), "--scan-set", "high_m=2"});
        const Outcome outcome = process(limits);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        told_ = outcome.err;
        return cv::countNonZero(images::read_image(path("out/im0.png")));
    };
    const int all = measured({});
    EXPECT_GT(all, width * height / 2);
    const std::string scan = read_file(path("scan.csv"));
    EXPECT_EQ(measured({"--min-distance-m", "1.9", "--max-distance-m", "2.1"}), all);
    EXPECT_THAT(told_, Not(HasSubstr("distance-m")));
    EXPECT_EQ(measured({"--max-distance-m", "1.9"}), 0);
    EXPECT_EQ(measured({"--min-distance-m", "2.1"}), 0);
    EXPECT_EQ(read_file(path("scan.csv")), scan) << "a scan sees everything";
    EXPECT_EQ(measured({"--min-distance-m", "0.1"}), all);
    EXPECT_THAT(told_, HasSubstr("--min-distance-m has no effect: "));
}

TEST_F(ProcessToldTest, LimitsOfDistanceThatCannotBe) {
    make_scene(20, "");
    const Outcome blind = process({path("in"), "--max-distance-m", "3"});
    EXPECT_EQ(blind.exit_code, 2);
    EXPECT_THAT(blind.err, HasSubstr("--max-distance-m: " + path("in") + " has no calibration"));
    const Outcome none = process({path("in"), "--max-distance-m", "3", "--min-distance-m", "3"});
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_THAT(none.err, HasSubstr("--max-distance-m: found no more than --min-distance-m, allowed: more than that"));
}

TEST_F(ProcessToldTest, HowFarTheFramesCanBeTrusted) {
    make_scene(20, middlebury_calibration(""));
    const Outcome good = process({path("in"), "--json"});
    ASSERT_EQ(good.exit_code, 0) << good.err;
    const auto trust = nlohmann::json::parse(good.out)["trust"];
    EXPECT_GT(trust["mean"].get<double>(), 0.5);
    EXPECT_TRUE(trust["frames_with"].empty()) << trust;
    // As an underexposed camera sees it.
    const Pair pair = shifted_pair(width, height, 20, 7);
    images::write_png(path("in/im0.png"), pair.left / 16);
    images::write_png(path("in/im1.png"), pair.right / 16);
    const Outcome dark = process({path("in"), "--force"});
    ASSERT_EQ(dark.exit_code, 0) << dark.err;
    EXPECT_THAT(dark.out, HasSubstr(" % on the average, dark in 1 frame"));
    const std::string times = read_file(path("out/times.csv"));
    EXPECT_THAT(times, HasSubstr(",dropped_before,trust,doubts,"));
    EXPECT_THAT(times, HasSubstr(",dark"));
}

TEST_F(ProcessToldTest, TheDistancesThatAreMeasured) {
    make_scene(20, middlebury_calibration(""));
    const Outcome outcome = process({path("in")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("nothing nearer than 0.64 m is measured"));
    EXPECT_THAT(outcome.out, HasSubstr("0.5 m needs 96 disparities"));
    const auto distances = geometry()["distances"];
    EXPECT_NEAR(distances["nearest_m"].get<double>(), 40.0 / 63, 1e-9);
    EXPECT_TRUE(distances["farthest_m"].is_null());
    EXPECT_EQ(distances["resolution"][0]["at_m"], 5);
    EXPECT_NEAR(distances["resolution"][0]["error_of_1px_m"].get<double>(), 40.0 / 7 - 5, 1e-9);
    EXPECT_EQ(distances["disparities_for"][1]["disparities"], 96);
    EXPECT_TRUE(outcome.err.empty()) << outcome.err;
}

TEST_F(ProcessToldTest, DistancesThatAreNotKnown) {
    make_scene(20, "");
    const Outcome outcome = process({path("in"), "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(outcome.out);
    EXPECT_TRUE(summary["distances"].is_null());
    EXPECT_GT(summary["measured"], 0.5);
    EXPECT_TRUE(geometry()["distances"].is_null());
    std::filesystem::remove_all(path("out"));
    EXPECT_THAT(process({path("in")}).out, HasSubstr("no calibration says the focal length and the baseline"));
}

TEST_F(ProcessToldTest, TheRangeOfADatasetIsThatOfItsFile) {
    make_scene(100, middlebury_calibration("ndisp=120\n"));
    const Outcome outcome = process({path("in"), "--json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("calib.txt says ndisp=120: 0 to 127 px are searched"));
    EXPECT_EQ(geometry()["match"]["disparities"], 128);
    EXPECT_GT(nlohmann::json::parse(outcome.out)["measured"], 0.5);
}

TEST_F(ProcessToldTest, TheRangeOfADatasetIsThatOfItsGroundTruth) {
    std::filesystem::create_directories(path("in/disp_occ_0"));
    make_kitti_folder(path("in"), 2, 96, 48);
    images::write_png(path("in/disp_occ_0/000000.png"), cv::Mat(48, 96, CV_16UC1, cv::Scalar(3 * 256)));
    images::write_png(path("in/disp_occ_0/000001.png"), cv::Mat(48, 96, CV_16UC1, cv::Scalar(82.5 * 256)));
    const Outcome outcome = process({path("in")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("reaches 83 px"), HasSubstr("0 to 95 px are searched")));
    EXPECT_EQ(geometry()["match"]["disparities"], 96);
}

TEST_F(ProcessToldTest, ARangeThatIsSmallerThanTheDatasets) {
    make_scene(20, middlebury_calibration("ndisp=300\n"));
    const Outcome given = process({path("in"), "--disparities", "64"});
    ASSERT_EQ(given.exit_code, 0) << given.err;
    EXPECT_THAT(given.err, AllOf(HasSubstr("ndisp=300, more than is searched: 0 to 63 px"),
                                 HasSubstr("--disparities 256 reaches farther")));
    EXPECT_EQ(geometry()["match"]["disparities"], 64);
    std::filesystem::remove_all(path("out"));
    EXPECT_THAT(process({path("in")}).err, HasSubstr("ndisp=300, more than is searched: 0 to 255 px"));
    std::filesystem::remove_all(path("out"));
    EXPECT_THAT(process({path("in"), "--d-min", "50"}).err, Not(HasSubstr("more than is searched")));
}

TEST_F(ProcessToldTest, ARangeThatDoesNotReachIsTold) {
    make_scene(100, "");
    const Outcome outcome = process({path("in")});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(" % of the pixels were measured; the likely cause: the range of "
                                             "disparities is too small"),
                                   HasSubstr("112 disparities would reach them")));
}

TEST_F(ProcessToldTest, ExchangedEyesAreTold) {
    make_scene(20, "");
    const Outcome outcome = process({path("in/im1.png"), path("in/im0.png"), "--preset", "dense"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("the likely cause: left and right are exchanged"));
}

}  // namespace
}  // namespace disparityd::test
