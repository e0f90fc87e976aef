// SPDX-License-Identifier: Apache-2.0
#include "capture/rectification_schedule.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "capture/scene_camera.h"
#include "image_fixture.h"
#include "record_fixture.h"

namespace disparityd::capture {
namespace {

using Follow = RectificationBook::Follow;

SourceInfo source() {
    SourceInfo info;
    info.eye_width = 320;
    info.height = 180;
    info.calibration = scene_calibration(320, 180);
    return info;
}

RawFrame frame(std::uint64_t sequence, const CalibrationCorrection& correction = {}) {
    RawFrame frame;
    frame.sequence = sequence;
    frame.correction = correction;
    return frame;
}

constexpr CalibrationCorrection some{2'000'000, 0, -1'000'000, 0};
constexpr CalibrationCorrection other{2'000'000, 300'000, -1'000'000, 500'000};

TEST(Correction, TurnsTheRightCameraInItsOwnAxes) {
    const StereoCalibration factory = scene_calibration(320, 180);
    const StereoCalibration turned = corrected(factory, {0, 0, 100'000'000, 20'000'000});
    cv::Matx33d turn;
    cv::Rodrigues(cv::Vec3d(0, 0, 0.1), turn);
    const cv::Matx33d expected = turn * cv::Matx33d(factory.rotation.data());
    EXPECT_LT(cv::norm(expected - cv::Matx33d(turned.rotation.data())), 1e-12);
    EXPECT_EQ(turned.translation, factory.translation);
    EXPECT_DOUBLE_EQ(turned.right.fx, 1.02 * factory.right.fx);
    EXPECT_DOUBLE_EQ(turned.right.fy, 1.02 * factory.right.fy);
    EXPECT_EQ(turned.left.fx, factory.left.fx);
    EXPECT_EQ(corrected(factory, {}).rotation, factory.rotation);
}

TEST(Correction, OfMoreThanThreeDegreesIsNone) {
    EXPECT_TRUE(is_plausible({52'000'000, -52'000'000, 52'000'000, -29'000'000}));
    EXPECT_FALSE(is_plausible({53'000'000, 0, 0, 0}));
    EXPECT_FALSE(is_plausible({0, std::numeric_limits<std::int32_t>::min(), 0, 0}));
    EXPECT_FALSE(is_plausible({0, 0, -53'000'000, 0}));
    EXPECT_FALSE(is_plausible({0, 0, 0, 31'000'000}));
}

TEST(Calibration, ComesBackFromYamlAsItWas) {
    const test::TemporaryFolder folder;
    StereoCalibration written = corrected(scene_calibration(672, 376), other);
    written.left.distortion[4] = 1e-17 / 3;
    test::write_file(folder.file("c.yml"), to_opencv_yaml(written));
    const StereoCalibration read = read_calibration(folder.file("c.yml"), 672, 376);
    written.origin = read.origin;
    EXPECT_EQ(to_text(read), to_text(written));
    EXPECT_THROW(read_calibration(folder.file("c.yml"), 640, 480), std::invalid_argument);
}

TEST(RectificationBook, AppliesFromTheNextFrameOn) {
    RectificationBook book(source(), {}, Follow::applied);
    RawFrame first = frame(40);
    EXPECT_EQ(book.for_frame(first)->calibration_id, book.factory().calibration_id);
    EXPECT_FALSE(first.correction.any());
    const auto made = book.made(some);
    EXPECT_NE(made->calibration_id, book.factory().calibration_id);
    book.apply(some, made);
    EXPECT_FALSE(book.state().since);
    for (const std::uint64_t sequence : {41U, 42U}) {
        RawFrame next = frame(sequence, other);  // what a source says does not count
        EXPECT_EQ(book.for_frame(next), made);
        EXPECT_EQ(next.correction, some);
    }
    EXPECT_EQ(book.state().since, 41U);
    EXPECT_EQ(book.state().correction, some);
}

TEST(RectificationBook, FollowsWhatIsRecorded) {
    RectificationBook book(source(), {}, Follow::recorded);
    RectificationBook same(source(), {}, Follow::applied);
    book.apply(other, book.made(other));
    for (const auto& [sequence, correction] :
         {std::pair(0, CalibrationCorrection{}), std::pair(1, some), std::pair(2, some), std::pair(3, other),
          std::pair(4, CalibrationCorrection{})}) {
        RawFrame next = frame(static_cast<std::uint64_t>(sequence), correction);
        EXPECT_EQ(book.for_frame(next)->calibration_id, same.made(correction)->calibration_id) << sequence;
        EXPECT_EQ(next.correction, correction);
    }
    EXPECT_EQ(book.state().since, 4U);
    RawFrame damaged = frame(5, {std::numeric_limits<std::int32_t>::min(), 0, 0, 0});
    EXPECT_THROW(book.for_frame(damaged), std::runtime_error);
}

TEST(RectificationBook, WithoutARawCalibrationThereIsNothingToCorrect) {
    for (const bool known : {false, true}) {
        SourceInfo info = source();
        info.calibration->rectified = true;
        if (!known) {
            info.calibration.reset();
        }
        RectificationBook book(info, {}, Follow::recorded);
        RawFrame next = frame(1, some);
        EXPECT_EQ(book.for_frame(next)->calibration_id, book.factory().calibration_id);
    }
}

TEST(FixedRectification, IsTheSameForEveryFrame) {
    const Rectification one = make_rectification(scene_calibration(320, 180), 320, 180, {});
    FixedRectification fixed(one);
    RawFrame next = frame(1);
    EXPECT_EQ(fixed.for_frame(next).get(), &one);
    EXPECT_EQ(&fixed.factory(), &one);
}

}  // namespace
}  // namespace disparityd::capture
