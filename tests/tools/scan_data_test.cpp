// SPDX-License-Identifier: Apache-2.0
//
// Scans of scenes with ground truth, against those that the true disparities give.
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "pipeline/worker_pool.h"
#include "tests/temporary_folder.h"
#include "tools/eval/scan/course.h"
#include "tools/eval/scan/data_report.h"
#include "tools/eval/scan/scan_comparison.h"
#include "tools/eval/scan/scan_report.h"
#include "tools/eval/scan/true_pixels.h"

namespace disparityd::eval {
namespace {

using disparityd::test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr float unknown_disparity = std::numeric_limits<float>::infinity();

std::vector<int> filled(std::vector<float> values, int width, int most_gap) {
    const int height = static_cast<int>(values.size()) / width;
    const TruePixels truth({width, height, std::move(values)}, most_gap);
    std::vector<int> seen;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const bool known = truth.pixels().confidence.at(x, y) > 0;
            seen.push_back(known ? truth.pixels().disparity.at(x, y) : -1);
        }
    }
    return seen;
}

TEST(TruePixels, GapsGetTheFartherNeighbour) {
    EXPECT_THAT(filled({unknown_disparity, 8, unknown_disparity, unknown_disparity, 4.5, unknown_disparity}, 6, 2),
                ElementsAre(-1, 128, 72, 72, 72, -1));
    EXPECT_THAT(filled({unknown_disparity, 8, unknown_disparity, unknown_disparity, 4.5, unknown_disparity}, 6, 1),
                ElementsAre(-1, 128, -1, -1, 72, -1));
    EXPECT_THAT(filled({3, unknown_disparity, 2}, 1, 8), ElementsAre(48, 32, 32)) << "in a column";
    EXPECT_THAT(filled({unknown_disparity, unknown_disparity}, 2, 8), ElementsAre(-1, -1));
}

ScanSector occupied(std::uint16_t mm, std::uint16_t free_mm) {
    return {.state = SectorState::occupied, .distance_mm = mm, .sigma_mm = 10, .free_mm = free_mm, .pixels = 50};
}
ScanSector free_to(std::uint16_t mm) {
    return {.state = SectorState::free, .free_mm = mm};
}
Scan scan_of(std::vector<ScanSector> sectors) {
    Scan scan;
    scan.sectors = std::move(sectors);
    return scan;
}

TEST(ScanComparison, TheSameScanIsPerfect) {
    const Scan truth = scan_of({occupied(2000, 2000), free_to(5000), {}, occupied(9000, 6000)});
    const ScanComparison same = compare(truth, truth, 8);
    EXPECT_EQ(same.sectors, 4);
    EXPECT_EQ(same.true_unknown, 1);
    EXPECT_EQ(same.unknown, 0);
    EXPECT_EQ(same.obstacles, 1) << "that at 9 m is too far to be asked for";
    EXPECT_EQ(same.missed, 0);
    EXPECT_EQ(same.false_alarms, 0);
    EXPECT_DOUBLE_EQ(same.free_share, 3);
    EXPECT_THAT(same.errors, ElementsAre(0));
}

TEST(ScanComparison, CountsWhatIsMissedAndWhatIsNotThere) {
    const Scan truth =
        scan_of({occupied(2000, 2000), free_to(5000), free_to(5000), free_to(5000), occupied(3000, 3000)});
    const Scan seen = scan_of({free_to(5000), free_to(2500), {}, occupied(4000, 4000), occupied(3150, 3000)});
    const ScanComparison counts = compare(seen, truth, 8);
    EXPECT_EQ(counts.obstacles, 2);
    EXPECT_EQ(counts.missed, 1);
    EXPECT_EQ(counts.declared_free, 1);
    EXPECT_EQ(counts.unknown, 1);
    EXPECT_EQ(counts.false_alarms, 1);
    EXPECT_THAT(counts.errors, ElementsAre(testing::DoubleNear(0.05, 1e-9)));
    EXPECT_DOUBLE_EQ(counts.free_share, 1 + 0.5 + 0 + 0.8 + 1);
    // In the next sector it counts; beyond where the truth is free, nobody knows.
    const Scan beside =
        scan_of({free_to(1900), occupied(2050, 2000), occupied(6000, 5000), free_to(1), occupied(3000, 1)});
    const ScanComparison near = compare(beside, truth, 8);
    EXPECT_EQ(near.missed, 0);
    EXPECT_EQ(near.false_alarms, 0);
}

/// A course as a folder of KITTI's layout, with points of the truth in every third column and second row only.
void write_kitti(const TemporaryFolder& folder, const Course& course, const CourseCamera& camera) {
    namespace fs = std::filesystem;
    for (const char* name : {"image_2", "image_3", "disp_occ_0", "calib_cam_to_cam"}) {
        fs::create_directory(folder.file(name));
    }
    CourseView view = draw(course, camera);
    const auto image = [&](std::vector<std::uint8_t>& pixels) {
        return cv::Mat(camera.height, camera.width, CV_8UC1, pixels.data());
    };
    cv::imwrite(folder.file("image_2/000007_10.png"), image(view.left));
    cv::imwrite(folder.file("image_3/000007_10.png"), image(view.right));
    cv::Mat truth(camera.height, camera.width, CV_16UC1, cv::Scalar(0));
    for (int y = 0; y < camera.height; y += 2) {
        for (int x = 0; x < camera.width; x += 3) {
            const double ahead = view.point[static_cast<std::size_t>(y * camera.width + x)].x;
            truth.at<std::uint16_t>(y, x) =
                static_cast<std::uint16_t>(ahead > 0 ? std::lround(256 * camera.f * camera.baseline_m / ahead) : 0);
        }
    }
    cv::imwrite(folder.file("disp_occ_0/000007_10.png"), truth);
    const std::string f = std::to_string(camera.f);
    const std::string row = f + " 0 " + std::to_string((camera.width - 1) / 2.0);
    const std::string rest = " 0 " + f + " " + std::to_string((camera.height - 1) / 2.0) + " 0 0 0 1 0\n";
    folder.write("calib_cam_to_cam/000007.txt", "P_rect_02: " + row + " 0" + rest + "P_rect_03: " + row + " " +
                                                    std::to_string(-camera.f * camera.baseline_m) + rest);
}

std::string report_of(const std::vector<std::string>& data) {
    DataEvaluation evaluation;
    evaluation.scenes = scenes_to_scan(data, 0);
    evaluation.match = [](int disparities) {
        MatchOptions options = preset_options(Preset::obstacles);
        options.range.count = disparities;
        return options;
    };
    evaluation.backend = &backend("cpu");
    pipeline::WorkerPool workers(1);
    const pipeline::WorkerPool::ComputeSlot slot(workers);
    testing::internal::CaptureStdout();
    report_data_scans(evaluation, workers, true);
    return testing::internal::GetCapturedStdout();
}

/// The numbers of a table's last row, behind its name.
std::vector<double> last_row(const std::string& table) {
    const std::size_t begin = table.rfind('\n', table.size() - 2) + 1;
    std::istringstream cells(table.substr(begin));
    std::vector<double> numbers;
    std::string cell;
    for (std::getline(cells, cell, '|'), std::getline(cells, cell, '|'); std::getline(cells, cell, '|');) {
        if (cell.find_first_of("0123456789") != std::string::npos) {
            numbers.push_back(std::stod(cell));
        }
    }
    return numbers;
}

TEST(ScanData, AFolderOfKittisLayoutIsJudgedByItsTruth) {
    const TemporaryFolder folder;
    CourseCamera camera;
    camera.width = 480;
    camera.height = 240;
    camera.f = 250;
    std::vector<Course> courses = make_courses(1, 1);
    write_kitti(folder, courses[1], camera);
    const std::string table = report_of({folder.path()});
    EXPECT_THAT(table, HasSubstr("/000007_10"));
    const std::vector<double> all = last_row(table);
    ASSERT_EQ(all.size(), 9U) << table;
    EXPECT_GT(all[0], 50) << "sectors of which the truth knows something\n" << table;
    EXPECT_GE(all[1], 10) << "obstacles\n" << table;
    EXPECT_LE(all[2], 1) << "missed\n" << table;
    EXPECT_EQ(all[3], 0) << "said free\n" << table;
    EXPECT_LE(all[4], 2) << "false alarms\n" << table;
    EXPECT_LT(all[7], 5) << "error\n" << table;
}

TEST(ScanData, ARenderedSceneHasATruth) {
    const std::vector<double> all = last_row(report_of({"scene:vga?width=320&height=180&frames=2"}));
    ASSERT_EQ(all.size(), 9U);
    EXPECT_GT(all[1], 30);
    EXPECT_LT(all[2], all[1] / 4);
}

TEST(ScanData, AFolderWithoutACalibrationIsRefused) {
    const TemporaryFolder folder;
    CourseCamera camera;
    camera.width = 64;
    camera.height = 48;
    write_kitti(folder, make_courses(1, 1)[0], camera);
    std::filesystem::remove_all(folder.file("calib_cam_to_cam"));
    try {
        report_of({folder.path()});
        FAIL() << "no distance is known";
    } catch (const std::invalid_argument& refusal) {
        testing::internal::GetCapturedStdout();
        EXPECT_THAT(refusal.what(), HasSubstr("found no calibration beside it"));
    }
}

TEST(ScanData, CoursesStandAlone) {
    EXPECT_EQ(seed_of_courses({"courses:7"}), 7U);
    EXPECT_EQ(seed_of_courses({"folder"}), std::nullopt);
    for (const std::vector<std::string>& wrong :
         {std::vector<std::string>{"courses:"}, {"courses:-1"}, {"courses:1.5"}, {"courses:1", "folder"}}) {
        EXPECT_THROW(seed_of_courses(wrong), std::invalid_argument) << wrong.front();
    }
}

TEST(Courses, AnApproachComesNearerByMoreThanItsSize) {
    const std::vector<Course> courses = make_courses(3, 2);
    int frames = 0;
    for (std::size_t i = 1; i < courses.size(); ++i) {
        if (!courses[i].sequel) {
            continue;
        }
        ASSERT_EQ(courses[i].kind, "fast approach");
        ASSERT_EQ(courses[i].obstacles.size(), 1U);
        const Obstacle& now = courses[i].obstacles[0];
        const Obstacle& before = courses[i - 1].obstacles[0];
        EXPECT_GT(before.centre.x - now.centre.x, 2 * now.half.x);
        EXPECT_EQ(before.half.x, now.half.x);
        ++frames;
    }
    EXPECT_EQ(frames, 2 * 5);
}

}  // namespace
}  // namespace disparityd::eval
