// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/transform_message.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/bridges/ros_messages/cdr_reader.h"

namespace disparityd::ros {
namespace {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

/// Returns the rotation matrix of a quaternion, row by row.
std::array<double, 9> matrix(const Quaternion& q) {
    const auto [x, y, z, w] = q;
    return {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
}

Vector turned(const Quaternion& q, const Vector& v) {
    const std::array<double, 9> m = matrix(q);
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
            m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

void expect_near(const Vector& found, const Vector& wanted) {
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i], wanted[i], 1e-12) << i;
    }
}

TEST(RosTransform, OpticalAxesBecomeTheRobots) {
    expect_near(turned(optical_to_robot, {0, 0, 1}), {1, 0, 0});
    expect_near(turned(optical_to_robot, {1, 0, 0}), {0, -1, 0});
    expect_near(turned(optical_to_robot, {0, 1, 0}), {0, 0, -1});
}

TEST(RosTransform, AMatrixAndItsQuaternionTurnAlike) {
    const double a = std::sqrt(0.5);
    // Each of the four parts is the largest once.
    for (const Quaternion& q : {Quaternion{0.1, 0.2, 0.3, std::sqrt(0.86)}, Quaternion{a, a, 0, 0},
                                Quaternion{0.9, 0.1, 0.2, std::sqrt(0.14)}, Quaternion{0.1, -0.9, 0.2, std::sqrt(0.14)},
                                Quaternion{0.1, 0.2, 0.9, std::sqrt(0.14)}, optical_to_robot}) {
        const Quaternion back = quaternion(matrix(q));
        EXPECT_GE(back[3], 0);
        const std::array<double, 9> once = matrix(q);
        const std::array<double, 9> twice = matrix(back);
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_NEAR(once[i], twice[i], 1e-12);
        }
    }
}

TEST(RosTransform, AnglesAreThoseOfTheDaemonsConfiguration) {
    const double c = std::cos(std::acos(-1.0) / 6);
    expect_near(turned(quaternion_of_degrees(0, 30, 0), {1, 0, 0}), {c, 0, -0.5});   // looks down
    expect_near(turned(quaternion_of_degrees(30, 0, 0), {0, 1, 0}), {0, c, 0.5});    // the left side is higher
    expect_near(turned(quaternion_of_degrees(0, 0, 30), {1, 0, 0}), {c, 0.5, 0});    // looks left
    expect_near(turned(quaternion_of_degrees(0, 30, 90), {1, 0, 0}), {0, c, -0.5});  // pitch first, then yaw
}

TEST(RosTransform, TheMessageHasEachTransform) {
    const std::array transforms{Transform{"base", "camera", {1, 2, 3}, {0, 0, 0, 1}},
                                Transform{"camera", "left", {}, optical_to_robot}};
    test::CdrReader cdr(transform_message(1'000'000'002, transforms));
    EXPECT_EQ(cdr.get<std::uint32_t>(), 2U);
    EXPECT_EQ(cdr.header(), "1.2 base");
    EXPECT_EQ(cdr.text(), "camera");
    EXPECT_EQ(cdr.get<double>(7), (std::vector<double>{1, 2, 3, 0, 0, 0, 1}));
    EXPECT_EQ(cdr.header(), "1.2 camera");
    EXPECT_EQ(cdr.text(), "left");
    EXPECT_EQ(cdr.get<double>(7), (std::vector<double>{0, 0, 0, -0.5, 0.5, -0.5, 0.5}));
    EXPECT_EQ(cdr.left(), 0U);
}

}  // namespace
}  // namespace disparityd::ros
