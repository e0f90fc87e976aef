// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "obstacles/scan.h"
#include "tools/eval/conditions/condition.h"
#include "tools/eval/conditions/frame_conditions.h"
#include "tools/eval/conditions/light_conditions.h"
#include "tools/eval/conditions/scene_conditions.h"
#include "tools/eval/scan/scan_judgement.h"

namespace disparityd::eval {
namespace {

constexpr int width = 320;
constexpr int height = 240;

EyePair plain_pair(int left, int right) {
    return {cv::Mat(height, width, CV_8UC1, cv::Scalar(left)), cv::Mat(height, width, CV_8UC1, cv::Scalar(right))};
}

Light plain_light(double level) {
    return {{cv::Mat(height, width, CV_32FC1, cv::Scalar(level)), cv::Mat(height, width, CV_32FC1, cv::Scalar(level))},
            {}};
}

/// How much of the variance of a plain image neighbours in a row share.
double shared_by_neighbours(const cv::Mat& image) {
    cv::Mat noise;
    image.convertTo(noise, CV_64F);
    noise -= cv::mean(noise);
    const cv::Mat one = noise.colRange(0, width - 1);
    const cv::Mat other = noise.colRange(1, width);
    return one.dot(other) / one.dot(one);
}

double sigma(const cv::Mat& image) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    return deviation[0];
}

TEST(Changes, NoiseHasItsSigmaAndIsSharedByNeighboursOrNot) {
    Draws draws(1);
    Light light = plain_light(120);
    add_noise(light, 5, draws);
    const EyePair alone = exposed(light, 7);
    EXPECT_NEAR(sigma(alone[0]), 5, 0.1);
    EXPECT_LT(std::abs(shared_by_neighbours(alone[0])), 0.02);
    EXPECT_GT(cv::norm(alone[0], alone[1], cv::NORM_INF), 0) << "both eyes have the same noise";
    add_shared_noise(light, 5, draws);
    const EyePair shared = exposed(light, 7);
    EXPECT_NEAR(sigma(shared[0]), 5, 0.2);
    EXPECT_NEAR(shared_by_neighbours(shared[0]), 2.0 / 3, 0.05) << "six of nine values are the same";
    Light dark = plain_light(30);
    add_noise(dark, 5, draws);
    EXPECT_LT(sigma(exposed(dark, 7)[0]), 4) << "light itself is noisy";
}

TEST(Changes, MotionBlurKeepsTheMeanAndSmoothsOneWay) {
    Draws draws(1);
    Light light = plain_light(100);
    for (int x = 0; x < width; x += 8) {
        light.eyes[0].col(x).setTo(200);
        light.eyes[1].row(x % height).setTo(200);
    }
    const double mean = cv::mean(light.eyes[0])[0];
    const double upright = sigma(light.eyes[0]);
    const double level = sigma(light.eyes[1]);
    blur_motion(light, 12, draws);
    EXPECT_NEAR(cv::mean(light.eyes[0])[0], mean, 1);
    const double kept_upright = sigma(light.eyes[0]) / upright;
    const double kept_level = sigma(light.eyes[1]) / level;
    EXPECT_LT(std::min(kept_upright, kept_level), 0.35);
    EXPECT_GT(std::max(kept_upright, kept_level), 1.3 * std::min(kept_upright, kept_level));
}

TEST(Changes, WhatIsInOneEyeLeavesTheOtherAlone) {
    for (const auto change : {rain_in_one, dust_in_one, drop_on_one, dirt_on_one, cover_one, expose_unequally}) {
        Draws draws(3);
        Light light = plain_light(100);
        light.eyes[0].rowRange(0, height / 2).setTo(150);
        light.eyes[1].rowRange(0, height / 2).setTo(150);
        const cv::Mat before = light.eyes[0].clone();
        change(light, 50, draws);
        const bool left = cv::norm(light.eyes[0], before, cv::NORM_INF) > 0;
        const bool right = cv::norm(light.eyes[1], before, cv::NORM_INF) > 0;
        EXPECT_NE(left, right);
    }
}

TEST(Changes, DirtAndACoverTakeTheirShare) {
    Draws draws(5);
    Light dirty = plain_light(200);
    dirt_on_one(dirty, 20, draws);
    const cv::Mat dark = (dirty.eyes[0] < 150) | (dirty.eyes[1] < 150);
    EXPECT_NEAR(cv::countNonZero(dark) / static_cast<double>(width * height), 0.2, 0.06);
    Light covered = plain_light(200);
    cover_one(covered, 50, draws);
    const cv::Mat hidden = (covered.eyes[0] < 100) | (covered.eyes[1] < 100);
    EXPECT_NEAR(cv::countNonZero(hidden) / static_cast<double>(width * height), 0.5, 0.02);
}

TEST(Changes, ADropOfRainIsWhereItsDistanceSays) {
    Draws draws(2);
    Light light = plain_light(50);
    rain_in_both(light, 1, draws);
    const cv::Rect left = cv::boundingRect(light.eyes[0] > 55);
    const cv::Rect right = cv::boundingRect(light.eyes[1] > 55);
    ASSERT_GT(left.area(), 0);
    ASSERT_GT(right.area(), 0);
    EXPECT_EQ(left.y, right.y);
    // 4 m at most: 5.25 px with this width.
    EXPECT_GE(left.x - right.x, 5);
}

TEST(Changes, TornFramesAreOldBelowARow) {
    const EyePair before = plain_pair(20, 30);
    const auto old_rows = [&](const cv::Mat& image, int old) {
        std::vector<int> rows;
        for (int y = 0; y < height; ++y) {
            if (cv::countNonZero(image.row(y) != old) == 0) {
                rows.push_back(y);
            }
        }
        EXPECT_TRUE(rows.empty() || rows.back() - rows.front() + 1 == static_cast<int>(rows.size()));
        EXPECT_TRUE(rows.empty() || rows.back() == height - 1);
        return rows.size();
    };
    Draws draws(1);
    EyePair one = plain_pair(200, 210);
    tear_one(one, before, draws);
    const auto left = old_rows(one[0], 20);
    const auto right = old_rows(one[1], 30);
    EXPECT_EQ(std::min(left, right), 0U);
    EXPECT_GE(std::max(left, right), height / 4U - 1);
    EyePair both = plain_pair(200, 210);
    tear_both(both, before, draws);
    EXPECT_EQ(old_rows(both[0], 20), old_rows(both[1], 30));
    EXPECT_GT(old_rows(both[0], 20), 0U);
}

TEST(Changes, LostBlocksAreOldAsAWhole) {
    Draws draws(1);
    EyePair images = plain_pair(200, 210);
    lose_blocks(images, plain_pair(20, 30), draws);
    constexpr int side = 64;
    int lost = 0;
    for (int y = 0; y + side <= height; y += side) {
        for (int x = 0; x + side <= width; x += side) {
            const int old = cv::countNonZero(images[0](cv::Rect(x, y, side, side)) == 20);
            EXPECT_TRUE(old == 0 || old == side * side);
            lost += old > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(lost, 0);
}

TEST(Changes, LowerQualityIsFartherFromTheImage) {
    Light light = plain_light(120);
    Draws draws(1);
    add_noise(light, 10, draws);
    const EyePair images = exposed(light, 1);
    double before = 0;
    for (const double quality : {80, 40, 15}) {
        EyePair compressed{images[0].clone(), images[1].clone()};
        compress(compressed, quality, draws);
        const double error = cv::norm(compressed[0], images[0]);
        EXPECT_GT(error, before);
        before = error;
    }
}

CourseCamera changed_camera() {
    CourseCamera camera;
    camera.width = width;
    camera.height = height;
    camera.f = 175;
    return camera;
}

Course empty_course() {
    Course course;
    course.seed = 3;
    return course;
}

TEST(Changes, GlassShowsWhatIsBehindAndAMirrorDoesNot) {
    const Course course = empty_course();
    CourseMaker glass(course, 1);
    add_glass(glass, 100);
    CourseMaker mirror(course, 1);
    add_mirror(mirror, 100);
    const CourseCamera camera = changed_camera();
    CourseView view;
    add_truth(glass.course, camera, view);
    const std::vector<double> open = draw_luma(course, camera, false, {});
    const std::vector<double> through = draw_luma(glass.course, camera, false, {});
    const std::vector<double> mirrored = draw_luma(mirror.course, camera, false, {});
    int on_pane = 0, mirror_differs = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
        if (view.object[i] == 0) {
            ++on_pane;
            EXPECT_LT(std::abs(through[i] - open[i]), 25) << "more than a weak reflection";
            mirror_differs += std::abs(mirrored[i] - open[i]) > 3 ? 1 : 0;
        }
    }
    EXPECT_GT(on_pane, 1000);
    EXPECT_GT(mirror_differs, on_pane / 2);
}

TEST(Changes, WhatIsAddedLooksAsIfAllWereDrawnAnew) {
    const Course course = empty_course();
    for (const auto add : {add_glass, add_slanted_wires, add_near_thing, add_hole}) {
        CourseMaker changed(course, 1);
        add(changed, 0.6);
        for (const bool right : {false, true}) {
            std::vector<double> luma = draw_luma(course, changed_camera(), right, {});
            draw_added(changed.course, changed_camera(), right, course.obstacles.size(), luma);
            EXPECT_EQ(luma, draw_luma(changed.course, changed_camera(), right, {}));
        }
    }
}

/// What a scan that says free everywhere counts.
ScanCounts judged_as_free(const Course& course) {
    const CourseCamera camera = changed_camera();
    CourseView view;
    add_truth(course, camera, view);
    Scan scan;
    for (int degrees = -40; degrees < 40; degrees += 5) {
        ScanSector sector{.state = SectorState::free, .free_mm = 20000};
        sector.from_cdeg = static_cast<decltype(sector.from_cdeg)>(100 * degrees);
        sector.to_cdeg = static_cast<decltype(sector.to_cdeg)>(100 * (degrees + 5));
        scan.sectors.push_back(sector);
    }
    return judge(scan, {}, view, course, camera, 64);
}

TEST(Changes, AHoleSaidFreeIsCounted) {
    Course course = empty_course();
    course.wall_m = 30;  // too far to be an obstacle
    EXPECT_EQ(judged_as_free(course).declared_free, 0);
    CourseMaker hole(course, 1);
    add_hole(hole, 0.8);
    EXPECT_GT(judged_as_free(hole.course).declared_free, 1);
    EXPECT_LT(judged_as_free(hole.course).declared_free, 16);
    CourseMaker step(course, 1);
    add_step_down(step, 0.3);
    EXPECT_EQ(judged_as_free(step.course).declared_free, 16);
}

TEST(Changes, ThingsStandWhereTheirStrengthSays) {
    CourseMaker near(empty_course(), 1);
    add_near_thing(near, 0.4);
    const Obstacle& box = near.course.obstacles.at(0);
    EXPECT_NEAR(box.centre.x - box.half.x, 0.4, 1e-9);
    CourseMaker wires(empty_course(), 1);
    add_slanted_wires(wires, 20);
    for (const Obstacle& wire : wires.course.obstacles) {
        EXPECT_EQ(wire.shape, Obstacle::Shape::bar);
        EXPECT_NEAR(2 * wire.half.x, 0.02, 1e-9);
    }
    CourseMaker fence(empty_course(), 1);
    add_fence(fence, 2);
    EXPECT_NEAR(fence.course.obstacles.back().centre.y - fence.course.obstacles.front().centre.y, 2, 0.15);
    CourseView view;
    add_truth(wires.course, changed_camera(), view);
    EXPECT_GT(std::count_if(view.object.begin(), view.object.end(), [](auto object) { return object >= 0; }), 50);
}

}  // namespace
}  // namespace disparityd::eval
