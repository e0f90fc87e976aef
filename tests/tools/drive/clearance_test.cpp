// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/clearance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace disparityd::eval {
namespace {

constexpr double tiny = 1e-9;

Course with(const Obstacle& obstacle) {
    Course course;
    course.wall_m = 100;
    course.obstacles.push_back(obstacle);
    return course;
}

double clearance_of(const Obstacle& obstacle, const Pose& pose = {}) {
    return clearance(with(obstacle), pose, {});
}

TEST(Clearance, OfABoxIsFromItsNearestSideOrCorner) {
    const Obstacle box{Obstacle::Shape::box, {2, 0, 0.2}, {0.1, 0.3, 0.2}, {}};
    EXPECT_NEAR(clearance_of(box), 2 - 0.1 - 0.25, tiny);
    EXPECT_NEAR(clearance_of(box, {1.5, 0.7, 2}), std::hypot(0.4, 0.4) - 0.25, tiny) << "wherever the robot looks";
    EXPECT_LT(clearance_of(box, {1.7, 0, 0}), 0);
    EXPECT_LT(clearance_of(box, {2, 0.5, 0}), 0) << "beside the camera's view";
}

TEST(Clearance, OfAPostIsFromItsSide) {
    EXPECT_NEAR(clearance_of({Obstacle::Shape::post, {1, 1, 0.5}, {0.05, 0, 0.5}, {}}), std::sqrt(2) - 0.05 - 0.25,
                tiny);
}

TEST(Clearance, OfAWireIsFromAllItsLength) {
    const Obstacle wire{Obstacle::Shape::wire, {2, 0, 0.5}, {0.01, 1, 0}, {}};
    EXPECT_NEAR(clearance_of(wire, {1, 1, 0}), 1 - 0.01 - 0.25, tiny);
    EXPECT_NEAR(clearance_of(wire, {2, 2, 0}), 1 - 0.01 - 0.25, tiny);
}

TEST(Clearance, OfABarCountsItsPartAtTheRobotsHeights) {
    // From (2, -0.5, 0) to (2, 0.5, 2): as high as the robot from y = -0.46 to y = -0.05.
    const Obstacle bar{Obstacle::Shape::bar, {2, 0, 1}, {0.01, 0.5, 1}, {}};
    EXPECT_NEAR(clearance_of(bar, {2, 0.5, 0}), 0.55 - 0.01 - 0.25, tiny);
    EXPECT_NEAR(clearance_of(bar, {2, -1, 0}), 0.54 - 0.01 - 0.25, tiny);
    EXPECT_NEAR(clearance_of({Obstacle::Shape::bar, {2, 0, 2}, {0.01, 0.5, 0.5}, {}}), 100 - 0.25, tiny) << "overhead";
}

TEST(Clearance, WhatIsLowOrOverheadIsNotMet) {
    EXPECT_NEAR(clearance_of({Obstacle::Shape::box, {0, 0, 0.04}, {1, 1, 0.04}, {}}), 100 - 0.25, tiny);
    EXPECT_NEAR(clearance_of({Obstacle::Shape::wire, {0, 0, 0.95}, {0.01, 1, 0}, {}}), 100 - 0.25, tiny);
    EXPECT_LT(clearance_of({Obstacle::Shape::box, {0, 0, 0.05}, {1, 1, 0.05}, {}}), 0);
}

TEST(Clearance, ARobotFallsIntoAHole) {
    const Obstacle hole{Obstacle::Shape::hole, {2, 0, -0.1}, {0.5, 0.5, 0.1}, {}};
    EXPECT_NEAR(clearance_of(hole), 1.5 - 0.25, tiny);
    EXPECT_LT(clearance_of(hole, {1.3, 0, 0}), 0);
}

TEST(Clearance, OfTheWallAhead) {
    Course course;
    course.wall_m = 9;
    EXPECT_NEAR(clearance(course, {3, 5, 0}, {}), 6 - 0.25, tiny);
}

}  // namespace
}  // namespace disparityd::eval
