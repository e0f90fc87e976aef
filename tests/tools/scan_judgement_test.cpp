// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/scan_judgement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "obstacles/obstacle_scanner.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {
namespace {

constexpr int disparities = 64;

CourseCamera small_camera() {
    CourseCamera camera;
    camera.width = 320;
    camera.height = 240;
    camera.f = 175;
    return camera;
}

Course course_of(const std::string& kind) {
    std::vector<Course> courses = make_courses(1, 1);
    const auto found =
        std::find_if(courses.begin(), courses.end(), [&](const Course& course) { return course.kind == kind; });
    EXPECT_NE(found, courses.end()) << kind;
    return *found;
}

/// The scan of what a perfect matcher would give: the disparity of each point that both eyes see.
Scan scan_of(const CourseView& view, const CourseCamera& camera, const ScanOptions& options) {
    const double k = 16 * camera.f * 1000 * camera.baseline_m;
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    for (std::size_t i = 0; i < view.point.size(); ++i) {
        const bool seen = view.both[i] != 0 && view.point[i].x > 0;
        disparity.push_back(static_cast<std::int16_t>(seen ? std::lround(k / (1000 * view.point[i].x)) : -16));
        confidence.push_back(seen ? 255 : 0);
    }
    ObstacleScanner scanner(camera.width, camera.height, options, fastest_frame_steps());
    Scan scan = scanner.empty_scan();
    scanner.scan({{disparity.data(), camera.width, camera.height, camera.width},
                  {confidence.data(), camera.width, camera.height, camera.width}},
                 {camera.width,
                  camera.height,
                  camera.f,
                  (camera.width - 1) / 2.0,
                  (camera.height - 1) / 2.0,
                  {std::lround(k), 0}},
                 scan);
    return scan;
}

TEST(ScanJudgement, PerfectDisparitiesMissNothing) {
    const CourseCamera camera = small_camera();
    const ScanOptions options;
    int obstacles = 0;
    for (const char* kind : {"open floor", "boxes", "thick poles", "ground slopes"}) {
        const Course course = course_of(kind);
        const CourseView view = draw(course, camera);
        const ScanCounts counts = judge(scan_of(view, camera, options), options, view, course, camera, disparities);
        obstacles += counts.obstacles;
        EXPECT_EQ(counts.missed, 0) << kind;
        EXPECT_EQ(counts.false_alarms, 0) << kind;
        EXPECT_EQ(counts.sectors, 72);
    }
    EXPECT_GT(obstacles, 30);
}

/// What a course counts when every sector of its scan shows the same.
ScanCounts judged_as(const std::string& kind, const ScanSector& shown) {
    const CourseCamera camera = small_camera();
    const ScanOptions options;
    const Course course = course_of(kind);
    const CourseView view = draw(course, camera);
    Scan scan = scan_of(view, camera, options);
    for (ScanSector& sector : scan.sectors) {
        const ScanSector was = sector;
        sector = shown;
        sector.from_cdeg = was.from_cdeg;
        sector.to_cdeg = was.to_cdeg;
    }
    return judge(scan, options, view, course, camera, disparities);
}

TEST(ScanJudgement, WhatIsNotShownIsMissed) {
    const ScanCounts unknown = judged_as("boxes", {.state = SectorState::unknown});
    EXPECT_EQ(unknown.missed, unknown.obstacles);
    EXPECT_EQ(unknown.declared_free, 0) << "unknown is not free";
    EXPECT_EQ(unknown.unknown, 72);
    const ScanCounts free = judged_as("boxes", {.state = SectorState::free, .free_mm = 20000});
    EXPECT_EQ(free.declared_free, free.obstacles);
}

TEST(ScanJudgement, WhatIsNotThereIsAFalseAlarm) {
    const ScanSector shown{.state = SectorState::occupied, .distance_mm = 2000, .sigma_mm = 10};
    EXPECT_EQ(judged_as("open floor", shown).false_alarms, 72);
}

TEST(Courses, SameSeedGivesTheSameCourses) {
    const CourseCamera camera = small_camera();
    const Course a = make_courses(5, 1).at(1);
    const Course b = make_courses(5, 1).at(1);
    const Course c = make_courses(6, 1).at(1);
    EXPECT_EQ(draw(a, camera).left, draw(b, camera).left);
    EXPECT_NE(draw(a, camera).left, draw(c, camera).left);
}

TEST(Courses, RightEyeSeesWhatTheDisparitySays) {
    // A point of the left image at x is at x - f B / Z in the right one. Noise is off.
    const CourseCamera camera = small_camera();
    Course course = course_of("open floor");
    course.noise = 0;
    const CourseView view = draw(course, camera);
    int checked = 0;
    double difference = 0;
    for (int y = 0; y < camera.height; y += 3) {
        for (int x = 60; x < camera.width; x += 3) {
            const auto i = static_cast<std::size_t>(y * camera.width + x);
            const double d = camera.f * camera.baseline_m / view.point[i].x;
            const int whole = static_cast<int>(std::lround(d));
            if (view.both[i] != 0 && std::abs(d - whole) < 0.05) {
                difference += std::abs(view.left[i] - view.right[i - static_cast<std::size_t>(whole)]);
                ++checked;
            }
        }
    }
    ASSERT_GT(checked, 100);
    EXPECT_LT(difference / checked, 3);
}

}  // namespace
}  // namespace disparityd::eval
