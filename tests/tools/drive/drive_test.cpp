// SPDX-License-Identifier: Apache-2.0
//
// Drives of a simulated robot: its motion, and that the example's decision keeps it from what its sight shows.
#include "tools/eval/drive/drive.h"

#include <cmath>

#include <gtest/gtest.h>

#include "kernels/matcher.h"
#include "tools/eval/drive/clearance.h"
#include "tools/eval/drive/drive_report.h"
#include "tools/eval/drive/robot_motion.h"
#include "tools/eval/drive/true_sight.h"

namespace disparityd::eval {
namespace {

constexpr std::uint32_t full_trust = 255U << 24U;

/// A view in which all is free up to a distance.
Seen free_up_to(double metres) {
    Seen seen;
    seen.flags = full_trust;
    seen.scan.sectors.push_back(
        {.from_deg = -60, .to_deg = 60, .state = disparity::SectorState::free, .free_m = metres});
    return seen;
}

Course course_with_a_box_ahead() {
    Course course;
    course.obstacles.push_back({Obstacle::Shape::box, {3, 0, 0.3}, {0.2, 5, 0.3}, {}});
    return course;
}

ScanSettings settings() {
    ScanSettings settings;
    settings.match = preset_options(Preset::obstacles, {0, 64});
    settings.backend = &backend("cpu");
    return settings;
}

TEST(RobotMotion, ObeysAfterItsReactionAndWithItsAcceleration) {
    const Robot robot;
    RobotMotion motion(robot);
    motion.give({1, 0});
    motion.move(robot.reaction_s);
    EXPECT_EQ(motion.speed_mps(), 0);
    motion.move(0.5);
    EXPECT_NEAR(motion.speed_mps(), 0.5 * robot.acceleration_mps2, 1e-9);
    motion.move(2);
    EXPECT_NEAR(motion.speed_mps(), 1, 1e-9);
    motion.give({0, 0});
    motion.move(robot.reaction_s);
    EXPECT_NEAR(motion.speed_mps(), 1, 1e-9);
    motion.move(0.25);
    EXPECT_NEAR(motion.speed_mps(), 1 - 0.25 * robot.deceleration_mps2, 1e-9);
    motion.move(1);
    EXPECT_EQ(motion.speed_mps(), 0) << "it does not go back";
}

TEST(RobotMotion, TurnsNoFasterThanItCan) {
    const Robot robot;
    RobotMotion motion(robot);
    motion.give({0, 10});
    motion.move(robot.reaction_s);
    motion.move(0.5);
    EXPECT_NEAR(motion.pose().yaw, 0.5 * robot.turn_rps, 1e-9);
}

TEST(Drive, ARobotThatIsToldThatAllIsFreeCollides) {
    const DriveResult result = drive(course_with_a_box_ahead(), {}, {}, [](const Pose&) { return free_up_to(20); });
    EXPECT_TRUE(result.collided);
    EXPECT_FALSE(result.reached);
    EXPECT_NEAR(result.gone_m, 2.8 - Robot().radius_m, 0.2);
}

TEST(Drive, ARobotThatSeesTheTruthStandsBeforeWhatItCannotPass) {
    const Course course = course_with_a_box_ahead();
    const DriveResult result = drive(course, {}, {}, true_sight(course, {}, settings()));
    EXPECT_FALSE(result.collided);
    EXPECT_FALSE(result.reached);
    EXPECT_GT(result.gone_m, 1);
    EXPECT_GT(result.least_clearance_m, 0.05);
}

TEST(Drive, ABlindRobotStands) {
    const DriveResult result = drive({}, {}, {}, [](const Pose&) { return free_up_to(0); });
    EXPECT_EQ(result.gone_m, 0);
    EXPECT_FALSE(result.reached);
}

TEST(Drive, AFreeWayIsDrivenAtFullSpeed) {
    const Robot robot;
    const DriveResult result = drive({}, robot, {}, [](const Pose&) { return free_up_to(20); });
    EXPECT_TRUE(result.reached);
    EXPECT_EQ(result.stops, 0);
    // Three frames end the first brake; then it accelerates.
    const double accelerating_s = robot.speed_mps / robot.acceleration_mps2;
    const double rest_m = DriveRules().goal_m - robot.speed_mps * accelerating_s / 2;
    const double begins_s = robot.latency_s + 2 / robot.frames_per_s + robot.reaction_s;
    EXPECT_NEAR(result.seconds, begins_s + accelerating_s + rest_m / robot.speed_mps, 0.1);
}

TEST(Drive, SeedsAreNamed) {
    EXPECT_EQ(seed_of_drives({"drive:7"}), 7U);
    EXPECT_EQ(seed_of_drives({"courses:7"}), std::nullopt);
}

TEST(DriveFigures, NoCollisionAndMostOfTheSpeedInCleanCourses) {
    DriveEvaluation evaluation;
    evaluation.settings = settings();
    DriveCounts counts;
    for (const Course& course : make_base_courses(2, 3)) {
        counts.add(count_drive(course, {}, evaluation));
    }
    EXPECT_EQ(counts.courses, 3);
    EXPECT_EQ(counts.collisions, 0);
    EXPECT_EQ(counts.true_collisions, 0);
    EXPECT_GE(counts.speed(), 0.7 * counts.true_speed());
}

}  // namespace
}  // namespace disparityd::eval
