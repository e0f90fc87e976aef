// SPDX-License-Identifier: Apache-2.0
//
// The eyes before rectification.
#include "bridges/ros_messages/raw_messages.h"

#include <numeric>

#include <gtest/gtest.h>

#include "bridges/ros_messages/encode.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Product;

disparity::Frame raw_frame() {
    disparity::Frame frame = test::bare_frame();
    std::vector<std::uint8_t> pixels(test::frame_width * test::frame_height);
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{1});
    frame.planes.push_back(test::plane_of_bytes(Product::raw_left, 1, pixels));
    return frame;
}

v1::Status status_with_lenses(std::uint64_t calibration_id) {
    v1::Status status;
    status.mutable_geometry()->set_calibration_id(calibration_id);
    status.mutable_geometry()->set_f(100);
    status.mutable_geometry()->set_baseline_mm(120);
    v1::RawCameras& cameras = *status.mutable_raw_cameras();
    cameras.set_width(8);
    cameras.set_height(4);
    for (v1::RawCamera* eye : {cameras.mutable_left(), cameras.mutable_right()}) {
        eye->set_fx(90);
        eye->set_fy(91);
        eye->set_cx(4.5);
        eye->set_cy(2.5);
        eye->set_lens("pinhole");
        for (int i = 0; i < 5; ++i) {
            eye->add_distortion(0.125 * i);
        }
        for (int i = 0; i < 9; ++i) {
            eye->add_rotation(i);
        }
    }
    cameras.mutable_right()->set_lens("fisheye");
    cameras.mutable_right()->mutable_distortion()->Truncate(4);
    return status;
}

TEST(RawMessages, TheImageIsTheOneBeforeRectification) {
    const auto message = encode(Content::raw_left_image, raw_frame(), {.names = {.raw = "eye"}});
    ASSERT_TRUE(message);
    EXPECT_NE(message->find("eye"), std::string::npos);
    EXPECT_NE(message->find("mono8"), std::string::npos);
    EXPECT_EQ(static_cast<std::uint8_t>(message->back()), test::frame_width * test::frame_height);
    EXPECT_FALSE(encode(Content::raw_right_image, raw_frame(), {}));
    EXPECT_FALSE(encode(Content::raw_left_image, test::grey_frame(), {}));
}

/// Returns what the fields of a CameraInfo are made of, in their order.
CameraInfoFields fields_of(const v1::RawCamera& eye, const disparity::Frame& frame) {
    CameraInfoFields fields{.realtime_ns = frame.realtime_ns, .frame = "eye", .width = 8, .height = 4};
    fields.d.assign(eye.distortion().begin(), eye.distortion().end());
    fields.k = {90, 0, 4.5, 0, 91, 2.5, 0, 0, 1};
    fields.r = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    return fields;
}

TEST(RawMessages, TheInformationIsOfTheLens) {
    const disparity::Frame frame = raw_frame();
    const v1::Status status = status_with_lenses(frame.calibration_id);
    const Encoding encoding{.names = {.raw = "eye"},
                            .raw = std::make_shared<const RawCalibration>(raw_calibration(status).value())};
    CameraInfoFields left = fields_of(status.raw_cameras().left(), frame);
    left.p = {100, 0, frame.cx, 0, 0, 100, frame.cy, 0, 0, 0, 1, 0};
    EXPECT_EQ(encode(Content::raw_left_info, frame, encoding), camera_info_message(left));
    CameraInfoFields right = fields_of(status.raw_cameras().right(), frame);
    right.model = "equidistant";
    right.p = {100, 0, frame.cx + 0.25, -12, 0, 100, frame.cy, 0, 0, 0, 1, 0};  // f B = 100 px x 0.12 m
    EXPECT_EQ(encode(Content::raw_right_info, frame, encoding), camera_info_message(right));
    EXPECT_EQ(left_turn(*encoding.raw)->at(8), 8);
}

TEST(RawMessages, NoInformationOfAnotherCalibration) {
    const disparity::Frame frame = raw_frame();
    const RawCalibration other = raw_calibration(status_with_lenses(frame.calibration_id + 1)).value();
    EXPECT_FALSE(raw_camera_info(frame, other, Camera::left, {}));
    EXPECT_FALSE(encode(Content::raw_left_info, frame, {}));
    EXPECT_FALSE(raw_calibration(v1::Status()));
}

TEST(RawMessages, NeedTheirProductsAndTheLenses) {
    const Offer offer{.products = {Product::left, Product::raw_left}, .calibrated = true, .lenses = true};
    EXPECT_EQ(needs_of(Content::raw_left_image, offer)->products, (std::vector{Product::raw_left}));
    EXPECT_EQ(needs_of(Content::raw_left_info, offer)->products, (std::vector{Product::raw_left}));
    EXPECT_FALSE(needs_of(Content::raw_right_image, offer));
    EXPECT_FALSE(needs_of(Content::raw_left_info, {.products = {Product::raw_left}, .calibrated = true}));
    EXPECT_TRUE(offer_of(status_with_lenses(1)).lenses);
}

}  // namespace
}  // namespace disparityd::ros
