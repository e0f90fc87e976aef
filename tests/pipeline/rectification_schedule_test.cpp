// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rectification_schedule.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "capture/scene/scene_camera.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::pipeline {
namespace {

using Follow = CorrectedRectification::Follow;

capture::SourceInfo source() {
    capture::SourceInfo info;
    info.eye_width = 320;
    info.height = 180;
    info.calibration = capture::scene_calibration(320, 180);
    return info;
}

capture::RawFrame frame(std::uint64_t sequence, const calibration::CalibrationCorrection& correction = {}) {
    capture::RawFrame frame;
    frame.sequence = sequence;
    frame.correction = correction;
    return frame;
}

constexpr calibration::CalibrationCorrection some{2'000'000, 0, -1'000'000, 0};
constexpr calibration::CalibrationCorrection other{2'000'000, 300'000, -1'000'000, 500'000};

TEST(Correction, TurnsTheRightCameraInItsOwnAxes) {
    const calibration::StereoCalibration factory = capture::scene_calibration(320, 180);
    const calibration::StereoCalibration turned = calibration::corrected(factory, {0, 0, 100'000'000, 20'000'000});
    cv::Matx33d turn;
    cv::Rodrigues(cv::Vec3d(0, 0, 0.1), turn);
    const cv::Matx33d expected = turn * cv::Matx33d(factory.rotation.data());
    EXPECT_LT(cv::norm(expected - cv::Matx33d(turned.rotation.data())), 1e-12);
    EXPECT_EQ(turned.translation, factory.translation);
    EXPECT_DOUBLE_EQ(turned.right.fx, 1.02 * factory.right.fx);
    EXPECT_DOUBLE_EQ(turned.right.fy, 1.02 * factory.right.fy);
    EXPECT_EQ(turned.left.fx, factory.left.fx);
    EXPECT_EQ(calibration::corrected(factory, {}).rotation, factory.rotation);
}

TEST(Correction, OfMoreThanThreeDegreesIsNone) {
    EXPECT_TRUE(calibration::is_plausible({52'000'000, -52'000'000, 52'000'000, -29'000'000}));
    EXPECT_FALSE(calibration::is_plausible({53'000'000, 0, 0, 0}));
    EXPECT_FALSE(calibration::is_plausible({0, std::numeric_limits<std::int32_t>::min(), 0, 0}));
    EXPECT_FALSE(calibration::is_plausible({0, 0, -53'000'000, 0}));
    EXPECT_FALSE(calibration::is_plausible({0, 0, 0, 31'000'000}));
}

TEST(Calibration, ComesBackFromYamlAsItWas) {
    const capture::test::TemporaryFolder folder;
    calibration::StereoCalibration written = calibration::corrected(capture::scene_calibration(672, 376), other);
    written.left.distortion[4] = 1e-17 / 3;
    capture::test::write_file(folder.file("c.yml"), calibration::to_opencv_yaml(written));
    const calibration::StereoCalibration read = calibration::read_calibration(folder.file("c.yml"), 672, 376);
    written.origin = read.origin;
    EXPECT_EQ(calibration::to_text(read), calibration::to_text(written));
    EXPECT_THROW(calibration::read_calibration(folder.file("c.yml"), 640, 480), std::invalid_argument);
}

TEST(CorrectedRectification, AppliesFromTheNextFrameOn) {
    CorrectedRectification corrected(source(), {}, Follow::applied);
    capture::RawFrame first = frame(40);
    EXPECT_EQ(corrected.for_frame(first)->calibration_id, corrected.factory().calibration_id);
    EXPECT_FALSE(first.correction.any());
    const auto made = corrected.build(some);
    EXPECT_NE(made->calibration_id, corrected.factory().calibration_id);
    corrected.apply(some, made);
    EXPECT_FALSE(corrected.state().since);
    for (const std::uint64_t sequence : {41U, 42U}) {
        capture::RawFrame next = frame(sequence, other);  // what a source says does not count
        EXPECT_EQ(corrected.for_frame(next), made);
        EXPECT_EQ(next.correction, some);
    }
    EXPECT_EQ(corrected.state().since, 41U);
    EXPECT_EQ(corrected.state().correction, some);
}

TEST(CorrectedRectification, FollowsWhatIsRecorded) {
    CorrectedRectification corrected(source(), {}, Follow::recorded);
    CorrectedRectification same(source(), {}, Follow::applied);
    corrected.apply(other, corrected.build(other));
    for (const auto& [sequence, correction] :
         {std::pair(0, calibration::CalibrationCorrection{}), std::pair(1, some), std::pair(2, some),
          std::pair(3, other), std::pair(4, calibration::CalibrationCorrection{})}) {
        capture::RawFrame next = frame(static_cast<std::uint64_t>(sequence), correction);
        EXPECT_EQ(corrected.for_frame(next)->calibration_id, same.build(correction)->calibration_id) << sequence;
        EXPECT_EQ(next.correction, correction);
    }
    EXPECT_EQ(corrected.state().since, 4U);
    capture::RawFrame damaged = frame(5, {std::numeric_limits<std::int32_t>::min(), 0, 0, 0});
    EXPECT_THROW(corrected.for_frame(damaged), std::runtime_error);
}

TEST(CorrectedRectification, WithoutARawCalibrationThereIsNothingToCorrect) {
    for (const bool known : {false, true}) {
        capture::SourceInfo info = source();
        info.calibration->rectified = true;
        if (!known) {
            info.calibration.reset();
        }
        CorrectedRectification corrected(info, {}, Follow::recorded);
        capture::RawFrame next = frame(1, some);
        EXPECT_EQ(corrected.for_frame(next)->calibration_id, corrected.factory().calibration_id);
    }
}

TEST(FixedRectification, IsTheSameForEveryFrame) {
    const calibration::Rectification one =
        calibration::make_rectification(capture::scene_calibration(320, 180), 320, 180, {});
    FixedRectification fixed(one);
    capture::RawFrame next = frame(1);
    EXPECT_EQ(fixed.for_frame(next).get(), &one);
    EXPECT_EQ(&fixed.factory(), &one);
}

}  // namespace
}  // namespace disparityd::pipeline
