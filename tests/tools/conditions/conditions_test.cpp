// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "tools/eval/conditions/condition.h"
#include "tools/eval/conditions/condition_report.h"
#include "tools/eval/conditions/course_in_conditions.h"

namespace disparityd::eval {
namespace {

using testing::HasSubstr;

/// Small, so that all conditions are drawn soon.
CourseCamera tiny_camera() {
    CourseCamera camera;
    camera.width = 160;
    camera.height = 120;
    camera.f = 87.5;
    return camera;
}

CourseInConditions tiny_course() {
    return {make_base_courses(1, 1).front(), tiny_camera()};
}

bool same(const EyePair& one, const EyePair& other) {
    return cv::norm(one[0], other[0], cv::NORM_INF) == 0 && cv::norm(one[1], other[1], cv::NORM_INF) == 0;
}

const Condition& named(const std::string& name) {
    return *conditions_named({name}).front();
}

double mean(const cv::Mat& image) {
    return cv::mean(image)[0];
}

TEST(Conditions, StrengthsAreApartAndGoOneWay) {
    std::set<std::string> names;
    for (const Condition& condition : conditions()) {
        const std::string name(condition.name);
        EXPECT_TRUE(names.insert(name).second) << name;
        const auto [low, middle, high] = condition.ranges;
        for (const StrengthRange& range : condition.ranges) {
            EXPECT_LE(range.from, range.to) << name;
        }
        const bool rises = low.to < middle.from && middle.to < high.from;
        const bool falls = high.to < middle.from && middle.to < low.from;
        EXPECT_TRUE(rises || falls) << name;
    }
}

TEST(Conditions, EachChangesTheImagesTheSameWayForTheSameSeed) {
    const CourseInConditions course = tiny_course();
    const CourseInConditions again = tiny_course();
    const EyePair clean = course.clean().images;
    EXPECT_TRUE(same(clean, again.clean().images));
    for (const Condition& condition : conditions()) {
        for (const Strength strength : all_strengths) {
            const EyePair images = course.in(condition, strength).images;
            EXPECT_FALSE(same(images, clean)) << condition.name << ' ' << to_string(strength);
            if (strength == Strength::middle) {
                EXPECT_TRUE(same(images, again.in(condition, strength).images)) << condition.name;
            }
        }
    }
    EXPECT_TRUE(same(clean, course.clean().images)) << "a condition has changed the course for those after it";
}

TEST(Conditions, TruthStaysWhereTheSceneDoes) {
    const CourseInConditions course = tiny_course();
    const Taken clean = course.clean();
    EXPECT_EQ(course.in(named("rain"), Strength::high).truth, clean.truth);
    EXPECT_EQ(course.in(named("eyes of two instants"), Strength::high).truth, clean.truth);
    const Taken fence = course.in(named("fence"), Strength::high);
    EXPECT_GT(fence.truth->course.obstacles.size(), clean.truth->course.obstacles.size() + 5);
    EXPECT_NE(fence.truth->view().object, clean.truth->view().object);
}

TEST(Conditions, LessLightIsDarkerAndMoreIsBrighter) {
    const CourseInConditions course = tiny_course();
    double before = mean(course.clean().images[0]);
    for (const Strength strength : all_strengths) {
        const double now = mean(course.in(named("low light"), strength).images[0]);
        EXPECT_LT(now, 0.6 * before);
        before = now;
    }
    before = mean(course.clean().images[0]);
    for (const Strength strength : all_strengths) {
        const double now = mean(course.in(named("overexposure"), strength).images[0]);
        EXPECT_GT(now, before);
        before = now;
    }
}

TEST(Conditions, UnequalEyesDifferByTheFactor) {
    const CourseInConditions course = tiny_course();
    const EyePair clean = course.clean().images;
    const EyePair images = course.in(named("unequal eyes"), Strength::middle).images;
    const double left = mean(images[0]) / mean(clean[0]);
    const double right = mean(images[1]) / mean(clean[1]);
    EXPECT_NEAR(std::max(left, right), 1, 0.001);
    EXPECT_GT(std::min(left, right), 0.49);
    EXPECT_LT(std::min(left, right), 0.61);
}

TEST(Conditions, ADriftedEyeAloneIsOff) {
    const CourseInConditions course = tiny_course();
    for (const char* name : {"rows off", "focal length off", "eyes of two instants"}) {
        const EyePair images = course.in(named(name), Strength::high).images;
        EXPECT_EQ(cv::norm(images[0], course.clean().images[0], cv::NORM_INF), 0) << name;
        EXPECT_GT(cv::norm(images[1], course.clean().images[1], cv::NORM_INF), 0) << name;
    }
}

TEST(Conditions, RowsAreOffBySoManyPixels) {
    const Course course = make_base_courses(1, 1).front();
    const CourseCamera camera = tiny_camera();
    EyeError error;
    error.rows = 3;
    const std::vector<double> clean = draw_luma(course, camera, true, {});
    const std::vector<double> lifted = draw_luma(course, camera, true, error);
    for (std::size_t i = 0; i + 3 * 160 < clean.size(); ++i) {
        ASSERT_NEAR(lifted[i], clean[i + 3 * 160], 1e-6) << "pixel " << i;
    }
}

TEST(Conditions, ATurnMovesWhatIsFarByItsAngle) {
    // The wall, 8 m or more ahead, moves to the right when the robot turns left.
    const Course course = make_base_courses(1, 1).front();
    const CourseCamera camera = tiny_camera();
    EyeError error;
    error.yaw_deg = std::atan(4 / camera.f) * 180 / M_PI;
    const std::vector<double> clean = draw_luma(course, camera, true, {});
    const std::vector<double> turned = draw_luma(course, camera, true, error);
    const auto difference = [&](int shift) {
        double sum = 0;
        for (int x = 60; x < 100; ++x) {
            const auto at = static_cast<std::size_t>(10 * camera.width + x);
            sum += std::abs(turned[at + static_cast<std::size_t>(shift)] - clean[at]);
        }
        return sum;
    };
    EXPECT_LT(difference(4), 0.5 * difference(0));
    EXPECT_LT(difference(4), 0.5 * difference(8));
}

TEST(Conditions, UnknownNamesAreRefused) {
    EXPECT_EQ(conditions_named({}).size(), conditions().size());
    EXPECT_EQ(conditions_named({"rain", "noise"}).front()->name, "noise") << "the order is the table's";
    try {
        conditions_named({"snow"});
        FAIL() << "there is none";
    } catch (const std::invalid_argument& refusal) {
        EXPECT_THAT(refusal.what(), HasSubstr("--condition: found 'snow', allowed: noise, shared noise, low light"));
    }
}

TEST(Conditions, ReportHasARowForEachStrength) {
    ConditionEvaluation evaluation;
    evaluation.settings.match.range = {0, 64};
    evaluation.settings.match.method = Method::sgm;
    evaluation.settings.match.post.min_texture = 1;
    evaluation.settings.backend = &backend("auto");
    evaluation.courses = 1;
    evaluation.names = {"covered eye"};
    Serial serial;
    testing::internal::CaptureStdout();
    report_conditions(evaluation, serial, true);
    const std::string table = testing::internal::GetCapturedStdout();
    EXPECT_THAT(table, HasSubstr("| clean |"));
    EXPECT_THAT(table, HasSubstr("| covered eye | low, 15 to 25 % of its width |"));
    EXPECT_THAT(table, HasSubstr("| covered eye | high, 100 % of its width |"));
    // Nothing is known where an eye sees nothing.
    EXPECT_THAT(table.substr(table.find("high")), HasSubstr("| 0.0 |\n"));
}

}  // namespace
}  // namespace disparityd::eval
