// SPDX-License-Identifier: Apache-2.0
#include "calibration/online/self_calibration.h"

#include <algorithm>
#include <numbers>
#include <ostream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/scene/scene_camera.h"
#include "tests/calibration/online/rectified_pair.h"

namespace disparityd::calibration {
namespace {

using test::nrad;
using testing::HasSubstr;

constexpr int width = 672;
constexpr int height = 376;
constexpr DisparityRange range{0, 64};

/// The calibration of the scene's camera, as it was before the right camera turned by `turned` (degrees).
struct Turned {
    double pitch = 0;
    double yaw = 0;
    double roll = 0;
};

StereoCalibration before(const Turned& turned) {
    return corrected(capture::scene_calibration(width, height),
                     {nrad(-turned.pitch), nrad(-turned.yaw), nrad(-turned.roll), 0});
}

const test::SceneFrames& scene() {
    static const test::SceneFrames frames("scene:vga@15?frames=4&seed=3");
    return frames;
}

SelfCalibrationResult estimate(const StereoCalibration& factory, int frames,
                               const CalibrationCorrection& already = {}) {
    SelfCalibration calibration(factory);
    for (int i = 0; i < frames; ++i) {
        const test::Pair pair = test::rectified(scene().frame(i), corrected(factory, already));
        calibration.add(pair.left.plane(), pair.right.plane(), pair.used, already, range);
    }
    return calibration.solve();
}

/// The requirement: 0.02 degrees.
constexpr double tolerance_degrees = 0.02;

void expect_near_degrees(double radians, double degrees, const char* what) {
    EXPECT_NEAR(radians * 180 / std::numbers::pi, degrees, tolerance_degrees) << what;
}

// What ctest lists; found by GoogleTest.
void PrintTo(const Turned& turned, std::ostream* out) {
    *out << "pitch " << turned.pitch << ", yaw " << turned.yaw << ", roll " << turned.roll;
}

class InjectedTurn : public testing::TestWithParam<Turned> {};

TEST_P(InjectedTurn, IsFoundAgain) {
    for (const int frames : {1, 4}) {
        const SelfCalibrationResult result = estimate(before(GetParam()), frames);
        ASSERT_TRUE(result.accepted) << result.reason;
        expect_near_degrees(result.correction.pitch_nrad * 1e-9, GetParam().pitch, "pitch");
        expect_near_degrees(result.correction.roll_nrad * 1e-9, GetParam().roll, "roll");
        EXPECT_LT(result.error_after, 0.1);
        EXPECT_LT(result.error_after, result.error_before);
    }
}

INSTANTIATE_TEST_SUITE_P(SelfCalibration, InjectedTurn,
                         testing::Values(Turned{0.3, 0, 0}, Turned{-0.3, 0, 0}, Turned{0, 0, 0.3}, Turned{0, 0, -0.5},
                                         Turned{0.15, 0, -0.2}, Turned{0.2, 0.3, 0.2}, Turned{-0.4, -0.3, 0.1}));

TEST(SelfCalibration, YawIsNotMistakenForPitchOrRoll) {
    for (const double yaw_degrees : {0.3, -0.3, 0.6}) {
        for (const int frames : {1, 4}) {
            const SelfCalibrationResult result = estimate(before({0, yaw_degrees, 0}), frames);
            expect_near_degrees(result.change[pitch], 0, "pitch");
            expect_near_degrees(result.change[roll], 0, "roll");
            expect_near_degrees(result.correction.pitch_nrad * 1e-9, 0, "pitch");
            expect_near_degrees(result.correction.roll_nrad * 1e-9, 0, "roll");
            // Taken over only where it is known to 0.05 px; then it is right.
            if (result.correction.yaw_nrad != 0) {
                expect_near_degrees(result.correction.yaw_nrad * 1e-9, yaw_degrees, "yaw");
            }
        }
    }
}

TEST(SelfCalibration, AGoodCalibrationIsLeftAlone) {
    const SelfCalibrationResult result = estimate(before({}), 4);
    EXPECT_FALSE(result.accepted);
    EXPECT_FALSE(result.correction.any());
    EXPECT_THAT(result.reason, HasSubstr("as good"));
    EXPECT_LT(result.error_before, 0.1);
}

TEST(SelfCalibration, CorrectsWhatIsCorrectedAlready) {
    const StereoCalibration factory = before({0.4, 0, -0.2});
    const SelfCalibrationResult result = estimate(factory, 2, {nrad(0.3), 0, nrad(0.1), 0});
    ASSERT_TRUE(result.accepted) << result.reason;
    expect_near_degrees(result.correction.pitch_nrad * 1e-9, 0.4, "pitch");
    expect_near_degrees(result.correction.roll_nrad * 1e-9, -0.2, "roll");
    EXPECT_GT(result.error_before, 1);  // of the factory's, not of what is in use
}

TEST(SelfCalibration, WhatIsInUseStaysUnlessItGetsBetter) {
    const StereoCalibration factory = before({0.4, 0, -0.2});
    SelfCalibration calibration(factory);
    const test::Pair pair = test::rectified(scene().frame(0), factory);
    calibration.add(pair.left.plane(), pair.right.plane(), pair.used, {}, range);
    const SelfCalibrationResult first = calibration.solve();
    ASSERT_TRUE(first.accepted) << first.reason;
    const SelfCalibrationResult second = calibration.solve(first.correction);
    EXPECT_FALSE(second.accepted);
    EXPECT_THAT(second.reason, HasSubstr("in use"));
}

TEST(SelfCalibration, SameFramesSameResult) {
    const StereoCalibration factory = before({0.2, 0, 0.1});
    const SelfCalibrationResult first = estimate(factory, 2);
    const SelfCalibrationResult second = estimate(factory, 2);
    EXPECT_EQ(first.correction, second.correction);
    EXPECT_EQ(first.change, second.change);
    EXPECT_EQ(first.deviation, second.deviation);
    EXPECT_EQ(first.reason, second.reason);
}

TEST(SelfCalibration, ARegionOfAScaledImageWillDo) {
    const StereoCalibration factory = before({-0.25, 0, 0.2});
    SelfCalibration calibration(factory);
    for (int i = 0; i < 4; ++i) {
        const test::Pair pair = test::rectified(scene().frame(i), factory, {504, 282, {40, 20, 420, 240}});
        calibration.add(pair.left.plane(), pair.right.plane(), pair.used, {}, range);
    }
    const SelfCalibrationResult result = calibration.solve();
    ASSERT_TRUE(result.accepted) << result.reason;
    expect_near_degrees(result.correction.pitch_nrad * 1e-9, -0.25, "pitch");
    expect_near_degrees(result.correction.roll_nrad * 1e-9, 0.2, "roll");
}

TEST(SelfCalibration, WithoutTextureNothingIsSaid) {
    const StereoCalibration factory = before({0.3, 0, 0});
    test::Pair pair = test::rectified(scene().frame(0), factory);
    std::fill(pair.left.pixels.begin(), pair.left.pixels.end(), std::uint8_t{90});
    SelfCalibration calibration(factory);
    EXPECT_FALSE(calibration.solve().accepted);
    calibration.add(pair.left.plane(), pair.right.plane(), pair.used, {}, range);
    const SelfCalibrationResult result = calibration.solve();
    EXPECT_FALSE(result.accepted);
    EXPECT_EQ(result.matches, 0);
    EXPECT_THAT(result.reason, HasSubstr("100 are needed"));
}

// All texture in one corner: pitch and yaw, roll and pitch cannot be told apart there.
TEST(SelfCalibration, AFewSquaresOfTextureAreNotEnough) {
    const StereoCalibration factory = before({0.3, 0, 0});
    SelfCalibration calibration(factory);
    for (int i = 0; i < 4; ++i) {
        test::Pair pair = test::rectified(scene().frame(i), factory);
        for (int y = 0; y < height; ++y) {
            std::uint8_t* row = pair.left.plane().row(y);
            std::fill(row + (y < 130 ? 230 : 0), row + width, std::uint8_t{90});
        }
        calibration.add(pair.left.plane(), pair.right.plane(), pair.used, {}, range);
    }
    const SelfCalibrationResult result = calibration.solve();
    EXPECT_GT(result.matches, 100);
    EXPECT_FALSE(result.accepted);
    EXPECT_THAT(result.reason, HasSubstr("are needed"));
}

TEST(SelfCalibration, RefusesWhatIsRectifiedAlready) {
    StereoCalibration factory = before({});
    factory.rectified = true;
    EXPECT_THROW(SelfCalibration{factory}, std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::calibration
