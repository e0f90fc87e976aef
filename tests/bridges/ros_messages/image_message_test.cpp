// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include "bridges/ros_messages/camera_info_message.h"
#include "bridges/ros_messages/image_messages.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::Product;
using test::CdrReader;
using Octets = std::vector<std::uint8_t>;

const std::string header = "1700000000.123456789 left_camera";

struct Image {
    std::string encoding;
    std::uint32_t step = 0;
    Octets data;

    float number(std::size_t i) const {
        float value{};
        std::memcpy(&value, &data.at(4 * i), sizeof value);
        return value;
    }
};

Image image_in(CdrReader& cdr) {
    EXPECT_EQ(cdr.header(), header);
    EXPECT_EQ(cdr.get<std::uint32_t>(), test::frame_height);
    EXPECT_EQ(cdr.get<std::uint32_t>(), test::frame_width);
    Image image;
    image.encoding = cdr.text();
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0) << "little endian";
    image.step = cdr.get<std::uint32_t>();
    image.data = cdr.sequence<std::uint8_t>();
    return image;
}

Image image_of(const std::optional<std::string>& message) {
    CdrReader cdr(message.value());
    Image image = image_in(cdr);
    EXPECT_EQ(cdr.left(), 0U);
    return image;
}

TEST(RosImage, LeftIsGreyOrColoured) {
    const Image grey = image_of(left_image(test::grey_frame()));
    EXPECT_EQ(grey.encoding, "mono8");
    EXPECT_EQ(grey.step, 8U);
    EXPECT_EQ(grey.data, test::grey_frame().plane(Product::left)->bytes);
    const Image colour = image_of(left_image(test::colour_frame()));
    EXPECT_EQ(colour.encoding, "rgb8");
    EXPECT_EQ(colour.step, 24U);
    Octets bgr = test::colour_frame().plane(Product::left_colour)->bytes;
    for (std::size_t i = 0; i < bgr.size(); i += 3) {
        std::swap(bgr[i], bgr[i + 2]);
    }
    EXPECT_EQ(colour.data, bgr);
}

TEST(RosImage, RowsAsACameraGivesThemLoseTheirGaps) {
    Octets rows(test::frame_height * 20);
    std::iota(rows.begin(), rows.end(), std::uint8_t{0});
    Octets expected;
    for (std::uint32_t y = 0; y < test::frame_height; ++y) {
        expected.insert(expected.end(), rows.begin() + 20 * y, rows.begin() + 20 * y + 2 * test::frame_width);
    }
    const Image image = image_of(rows_image({.width = test::frame_width,
                                             .height = test::frame_height,
                                             .encoding = "yuv422_yuy2",
                                             .bytes_per_pixel = 2,
                                             .data = rows.data(),
                                             .stride = 20},
                                            test::grey_frame().realtime_ns, "left_camera"));
    EXPECT_EQ(image.encoding, "yuv422_yuy2");
    EXPECT_EQ(image.step, 2 * test::frame_width);
    EXPECT_EQ(image.data, expected);
}

TEST(RosImage, TheRightEyeHasItsOwnPlanesAndTheLeftFrame) {
    Frame frame = test::grey_frame();
    EXPECT_FALSE(right_image(frame));
    frame.planes.push_back(test::plane_of_bytes(Product::right, 1, Octets(32, 9)));
    const Image grey = image_of(right_image(frame));
    EXPECT_EQ(grey.encoding, "mono8");
    EXPECT_EQ(grey.data, Octets(32, 9));
    frame.planes.push_back(test::plane_of_bytes(Product::right_colour, 3, Octets(96, 5)));
    EXPECT_EQ(image_of(right_image(frame)).encoding, "rgb8");
    EXPECT_EQ(image_of(right_grey_image(frame)).encoding, "mono8");
    EXPECT_FALSE(left_grey_image(test::colour_frame()));
}

TEST(RosImage, NamesOfFramesAreTheCallers) {
    const std::optional<std::string> message = left_image(test::grey_frame(), {.left = "a_left"});
    EXPECT_EQ(CdrReader(message.value()).header(), "1700000000.123456789 a_left");
}

TEST(RosImage, DepthHasWordsForUnknownAndTooFar) {
    const Image image = image_of(depth_image(test::grey_frame()));
    EXPECT_EQ(image.encoding, "32FC1");
    EXPECT_EQ(image.step, 32U);
    EXPECT_TRUE(std::isnan(image.number(0)));
    EXPECT_EQ(image.number(1), INFINITY);
    EXPECT_EQ(image.number(2), 1.002F);
}

TEST(RosImage, DepthComesFromDisparitiesWhereThereIsNoOther) {
    Frame frame = test::colour_frame();
    const Image image = image_of(depth_image(frame));
    EXPECT_TRUE(std::isnan(image.number(0)));
    EXPECT_EQ(image.number(1), INFINITY) << "-4/16 + 0.25 px";
    EXPECT_FLOAT_EQ(image.number(2), 12 / (2.125F + 0.25F)) << "the offset is added";
    frame.baseline_mm = 0;
    EXPECT_FALSE(depth_image(frame));
}

TEST(RosImage, DepthInMillimetresIsTheDaemons) {
    const Image image = image_of(depth_mm_image(test::grey_frame()));
    EXPECT_EQ(image.encoding, "16UC1");
    EXPECT_EQ(image.step, 16U);
    EXPECT_EQ(image.data, test::grey_frame().plane(Product::depth)->bytes);
    EXPECT_FALSE(depth_mm_image(test::colour_frame()));
}

TEST(RosImage, DepthErrorIsInMetres) {
    const Image image = image_of(depth_error_image(test::grey_frame()));
    EXPECT_TRUE(std::isnan(image.number(0)));
    EXPECT_EQ(image.number(1), INFINITY);
    EXPECT_EQ(image.number(2), 0.012F);
}

TEST(RosImage, DisparitiesHaveTheOffset) {
    const std::optional<std::string> message = disparity_image(test::grey_frame());
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), header);
    const Image image = image_in(cdr);
    EXPECT_EQ(image.number(2), 2.125F + 0.25F);
    EXPECT_EQ(image.number(0), -0.75F) << "rejected: min_disparity - 1";
    EXPECT_EQ(cdr.get<float>(), 100.0F);
    EXPECT_EQ(cdr.get<float>(), 0.12F);
    EXPECT_EQ(cdr.get<std::uint32_t>(4), (std::vector<std::uint32_t>{0, 0, test::frame_height, test::frame_width}));
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0);
    EXPECT_EQ(cdr.get<float>(3), (std::vector<float>{0.25F, 63.25F, 0.0625F}));
    EXPECT_EQ(cdr.left(), 0U);
}

TEST(RosImage, APlaneThatIsNotThereOrNotWholeGivesNoMessage) {
    Frame frame = test::grey_frame();
    for (disparity::PlaneData& plane : frame.planes) {
        plane.bytes.pop_back();
    }
    EXPECT_FALSE(left_image(frame));
    EXPECT_FALSE(left_jpeg(frame, 85));
    EXPECT_FALSE(confidence_image(frame));
    EXPECT_FALSE(depth_image(frame));
    EXPECT_FALSE(depth_mm_image(frame));
    EXPECT_FALSE(depth_error_image(frame));
    EXPECT_FALSE(disparity_image(frame));
    EXPECT_FALSE(left_image(test::bare_frame()));
}

/// Returns the bytes of a message's file.
Octets jpeg_in(const std::optional<std::string>& message) {
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), header);
    EXPECT_EQ(cdr.text(), "jpeg");
    const Octets file = cdr.sequence<std::uint8_t>();
    EXPECT_EQ(cdr.left(), 0U);
    return file;
}

void expect_file_shows(const Octets& file, int pixel_format, const disparity::PlaneData& plane) {
    tjhandle decoder = tjInitDecompress();
    Octets pixels(plane.bytes.size());
    ASSERT_EQ(tjDecompress2(decoder, file.data(), file.size(), pixels.data(), test::frame_width, 0, test::frame_height,
                            pixel_format, 0),
              0);
    tjDestroy(decoder);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        EXPECT_NEAR(pixels[i], plane.bytes[i], 16) << i;
    }
}

TEST(RosImage, JpegShowsTheImage) {
    Frame grey = test::grey_frame();
    expect_file_shows(jpeg_in(left_jpeg(grey, 100)), TJPF_GRAY, *grey.plane(Product::left));
    Frame colour = test::colour_frame();
    for (std::size_t i = 0; i < 96; i += 3) {  // one colour: what JPEG does to small changes of colour is not the point
        colour.planes[1].bytes[i] = 30;
        colour.planes[1].bytes[i + 1] = 90;
        colour.planes[1].bytes[i + 2] = 200;
    }
    expect_file_shows(jpeg_in(left_jpeg(colour, 100)), TJPF_BGR, *colour.plane(Product::left_colour));
}

struct Info {
    std::vector<double> k;
    std::vector<double> p;
    std::vector<std::uint32_t> region;
};

Info info_in(const std::optional<std::string>& message) {
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), header);
    EXPECT_EQ(cdr.get<std::uint32_t>(2), (std::vector<std::uint32_t>{test::frame_height, test::frame_width}));
    EXPECT_EQ(cdr.text(), "plumb_bob");
    EXPECT_EQ(cdr.sequence<double>(), std::vector<double>(5));
    Info info;
    info.k = cdr.get<double>(9);
    EXPECT_EQ(cdr.get<double>(9), (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    info.p = cdr.get<double>(12);
    EXPECT_EQ(cdr.get<std::uint32_t>(2), (std::vector<std::uint32_t>{0, 0})) << "binning";
    info.region = cdr.get<std::uint32_t>(4);
    EXPECT_EQ(cdr.get<std::uint8_t>(), 0);
    EXPECT_EQ(cdr.left(), 0U);
    return info;
}

TEST(RosCameraInfo, TheRightCameraIsABaselineAway) {
    const Info left = info_in(camera_info(test::grey_frame(), Camera::left));
    EXPECT_EQ(left.k, (std::vector<double>{100, 0, 3.5, 0, 100, 1.5, 0, 0, 1}));
    EXPECT_EQ(left.p, (std::vector<double>{100, 0, 3.5, 0, 0, 100, 1.5, 0, 0, 0, 1, 0}));
    EXPECT_EQ(left.region, (std::vector<std::uint32_t>{0, 0, 0, 0}));
    const Info right = info_in(camera_info(test::grey_frame(), Camera::right));
    EXPECT_EQ(right.k, (std::vector<double>{100, 0, 3.75, 0, 100, 1.5, 0, 0, 1})) << "the offset";
    EXPECT_EQ(right.p, (std::vector<double>{100, 0, 3.75, -12, 0, 100, 1.5, 0, 0, 0, 1, 0})) << "-f B";
}

// A point at (X, Y, Z) is seen at x and x' = (f X + cx' Z + P[3]) / Z; the daemon's disparity is x - x'.
TEST(RosCameraInfo, BothCamerasAgreeWithTheDisparity) {
    const std::vector<double> p = info_in(camera_info(test::grey_frame(), Camera::right)).p;
    const double z = 2.5;
    const double x = 6;
    const double x_metres = (x - 3.5) * z / 100;
    const double right_x = (p[0] * x_metres + p[2] * z + p[3]) / z;
    const double disparity = x - right_x;
    EXPECT_NEAR(100 * 0.12 / (disparity + 0.25), z, 1e-12);
}

TEST(RosCameraInfo, ARegionIsTold) {
    Frame frame = test::grey_frame();
    frame.width = 20;
    frame.height = 10;
    frame.region_x = 5;
    frame.region_y = 3;
    const std::optional<std::string> message = camera_info(frame, Camera::left);
    CdrReader cdr(message.value());
    cdr.header();
    EXPECT_EQ(cdr.get<std::uint32_t>(2), (std::vector<std::uint32_t>{10, 20}));
    EXPECT_EQ(CdrReader(test::bytes({0, 1, 0, 0}) + message->substr(message->size() - 17)).get<std::uint32_t>(4),
              (std::vector<std::uint32_t>{5, 3, 4, 8}));
}

TEST(RosCameraInfo, ThereIsNoneWithoutACalibration) {
    Frame frame = test::grey_frame();
    frame.f = 0;
    EXPECT_FALSE(camera_info(frame, Camera::left));
    frame = test::grey_frame();
    frame.baseline_mm = 0;
    EXPECT_FALSE(camera_info(frame, Camera::right));
    frame = test::grey_frame();
    frame.flags = disparity::unrectified;
    EXPECT_FALSE(camera_info(frame, Camera::left));
}

}  // namespace
}  // namespace disparityd::ros
