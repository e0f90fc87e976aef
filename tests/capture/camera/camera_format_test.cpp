// SPDX-License-Identifier: Apache-2.0
//
// Formats that are not lent as they are sent.
#include "capture/camera/camera_format.h"

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "capture/camera/camera_source.h"
#include "capture/camera/eye_joiner.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

TEST(CameraFormat, NamesAreTheKernels) {
    const std::pair<const char*, std::uint32_t> known[] = {
        {"yuyv", V4L2_PIX_FMT_YUYV},    {"grey", V4L2_PIX_FMT_GREY},    {"mjpeg", V4L2_PIX_FMT_MJPEG},
        {"y8i", V4L2_PIX_FMT_Y8I},      {"y12i", V4L2_PIX_FMT_Y12I},    {"bggr8", V4L2_PIX_FMT_SBGGR8},
        {"gbrg8", V4L2_PIX_FMT_SGBRG8}, {"grbg8", V4L2_PIX_FMT_SGRBG8}, {"rggb8", V4L2_PIX_FMT_SRGGB8}};
    for (const auto& [name, fourcc] : known) {
        ASSERT_NE(camera_format_of_name(name), nullptr) << name;
        EXPECT_EQ(camera_format_of_name(name)->fourcc, fourcc) << name;
        EXPECT_EQ(camera_format_of_fourcc(fourcc), camera_format_of_name(name));
    }
    EXPECT_EQ(camera_format_of_name("h264"), nullptr);
}

TEST(CameraFormat, TwelveBitsOfEachEyeAreTakenApart) {
    // Left 0xabc and 0x123, right 0xdef and 0x456: two numbers in three bytes, the lowest bits first.
    const std::uint8_t sent[] = {0xbc, 0xfa, 0xde, 0x23, 0x61, 0x45};
    for (const bool right_first : {false, true}) {
        EyeJoiner joiner({2, 1, false, right_first, true}, *camera_format_of_name("y12i"), 1);
        const int index = joiner.join(sent, 6);
        const std::vector<std::uint8_t> joined(joiner.data(index), joiner.data(index) + 4);
        if (right_first) {
            EXPECT_THAT(joined, ElementsAre(0xde, 0x45, 0xab, 0x12));
        } else {
            EXPECT_THAT(joined, ElementsAre(0xab, 0x12, 0xde, 0x45));
        }
    }
}

/// A made camera that sends one colour for all pixels through a Bayer pattern, named by its first two rows.
class BayerTest : public ::testing::TestWithParam<const char*> {
protected:
    static constexpr std::array<std::uint8_t, 3> left_colour{10, 90, 200};  // blue, green, red
    static constexpr std::array<std::uint8_t, 3> right_colour{250, 60, 20};

    static std::uint8_t sent(const std::string& pattern, std::size_t row, std::size_t column,
                             const std::array<std::uint8_t, 3>& colour) {
        const char letter = pattern[2 * (row % 2) + column % 2];
        return colour[letter == 'b' ? 0 : letter == 'g' ? 1 : 2];
    }
};

TEST_P(BayerTest, EachEyeGetsItsColourAndNothingOfTheOther) {
    constexpr std::size_t eye = 16;
    for (const bool top_bottom : {false, true}) {
        const std::size_t width = top_bottom ? eye : 2 * eye;
        const std::size_t height = top_bottom ? 2 * eye : eye;
        test::FakeVideoSystem system;
        test::FakeVideoSystem::Camera camera = test::zed2();
        camera.usb.vendor = 0x1234;
        camera.width = static_cast<int>(width);
        camera.height = static_cast<int>(height);
        camera.format = camera_format_of_name(GetParam())->fourcc;
        camera.draw = [&](std::uint32_t, std::vector<std::uint8_t>& picture) {
            for (std::size_t i = 0; i < picture.size(); ++i) {
                const bool right = top_bottom ? i / width >= eye : i % width >= eye;
                picture[i] = sent(GetParam(), i / width, i % width, right ? right_colour : left_colour);
            }
        };
        system.plug(camera);
        SourceOptions options;
        options.uri = "v4l2:" + std::to_string(width) + "x" + std::to_string(height) + "@30?format=" + GetParam() +
                      (top_bottom ? "&layout=top-bottom" : "");
        const auto source = open_camera_on(system, options);
        RawFrame frame;
        ASSERT_EQ(source->next(frame, system.now() + 1s), FrameSource::Next::frame);
        ASSERT_EQ(frame.image.format, PixelFormat::bgr24);
        ASSERT_EQ(frame.image.eye_width, static_cast<int>(eye));
        for (int y = 0; y < frame.image.height; ++y) {
            for (std::size_t x = 0; x < 3 * eye; ++x) {
                ASSERT_EQ(frame.image.eye(Eye::left).row(y)[x], left_colour[x % 3]) << y << ' ' << x;
                ASSERT_EQ(frame.image.eye(Eye::right).row(y)[x], right_colour[x % 3]) << y << ' ' << x;
            }
        }
        source->give_back(frame);
    }
}

INSTANTIATE_TEST_SUITE_P(Patterns, BayerTest, ::testing::Values("bggr8", "gbrg8", "grbg8", "rggb8"));

}  // namespace
}  // namespace disparityd::capture
