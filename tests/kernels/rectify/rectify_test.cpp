// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

constexpr int eye_width = 38;
constexpr int source_height = 29;

// Both eyes side by side, rows padded by a few bytes.
struct Source {
    Source(Random& random, PixelFormat format)
        : bytes(noise(random, 2 * eye_width * bytes_per_pixel(format) + 5, source_height)) {
        raw = {bytes.plane().data, format, eye_width, source_height, bytes.width()};
    }
    cv::Mat eye(Eye which) {
        const Plane<const std::uint8_t> plane = raw.eye(which);
        return {plane.height, eye_width, CV_8UC(bytes_per_pixel(raw.format)), const_cast<std::uint8_t*>(plane.data),
                static_cast<std::size_t>(plane.stride)};
    }
    Image<std::uint8_t> bytes;
    RawImage raw;
};

cv::Mat luma(const cv::Mat& eye, PixelFormat format) {
    cv::Mat grey;
    switch (format) {
        case PixelFormat::grey8: grey = eye.clone(); break;
        case PixelFormat::yuyv: cv::extractChannel(eye, grey, 0); break;
        case PixelFormat::bgr24: cv::cvtColor(eye, grey, cv::COLOR_BGR2GRAY); break;
    }
    return grey;
}

cv::Mat colour(const cv::Mat& eye, PixelFormat format) {
    cv::Mat bgr;
    switch (format) {
        case PixelFormat::grey8: cv::cvtColor(eye, bgr, cv::COLOR_GRAY2BGR); break;
        case PixelFormat::yuyv: cv::cvtColor(eye, bgr, cv::COLOR_YUV2BGR_YUYV); break;
        case PixelFormat::bgr24: bgr = eye.clone(); break;
    }
    return bgr;
}

// Random maps: most entries inside, some across each border, some far outside.
struct Maps {
    Maps(Random& random, int width, int height) : xy(height, width, CV_16SC2), fraction(height, width, CV_16UC1) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const bool far = pick(random, 0, 19) == 0;
                xy.at<cv::Vec2s>(y, x) = {
                    static_cast<short>(far ? pick(random, -32768, 32767) : pick(random, -3, eye_width + 2)),
                    static_cast<short>(far ? pick(random, -32768, 32767) : pick(random, -3, source_height + 2))};
                fraction.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(pick(random, 0, 1023));
            }
        }
    }
    RectifyMap view() const {
        return {{xy.ptr<std::int16_t>(), 2 * xy.cols, xy.rows, 2 * xy.cols},
                {fraction.ptr<std::uint16_t>(), xy.cols, xy.rows, xy.cols}};
    }
    cv::Mat xy, fraction;
};

void expect_equal(const cv::Mat& expected, const Image<std::uint8_t>& found) {
    ASSERT_EQ(expected.rows, found.height());
    ASSERT_EQ(expected.cols * expected.channels(), found.width());
    for (int y = 0; y < expected.rows; ++y) {
        for (int x = 0; x < found.width(); ++x) {
            ASSERT_EQ(expected.ptr(y)[x], found.at(x, y)) << "at " << x << ", " << y;
        }
    }
}

class Rectify : public testing::TestWithParam<PixelFormat> {};

TEST_P(Rectify, EqualsOpenCvRemapBitForBit) {
    Random random(1);
    for (const auto& [width, height] : {std::pair{45, 31}, {1, 1}, {160, 90}}) {
        Source source(random, GetParam());
        const Maps left(random, width, height);
        const Maps right(random, width, height);
        const Rectifier rectifier{true, left.view(), right.view()};
        for (const Eye eye : {Eye::left, Eye::right}) {
            const Maps& maps = eye == Eye::left ? left : right;
            cv::Mat expected;
            cv::remap(luma(source.eye(eye), GetParam()), expected, maps.xy, maps.fraction, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 0);
            Image<std::uint8_t> found(width, height, 99);
            reference::rectify(source.raw, eye, rectifier, found.plane(), found.rows());
            expect_equal(expected, found);
        }
        for (const Eye eye : {Eye::left, Eye::right}) {
            const Maps& maps = eye == Eye::left ? left : right;
            cv::Mat expected;
            cv::remap(colour(source.eye(eye), GetParam()), expected, maps.xy, maps.fraction, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 0);
            Image<std::uint8_t> found(3 * width, height, 99);
            reference::rectify_colour(source.raw, eye, rectifier, found.plane(), found.rows());
            expect_equal(expected, found);
        }
    }
}

TEST_P(Rectify, CropsWithoutMaps) {
    Random random(2);
    Source source(random, GetParam());
    const Rectifier rectifier{false, {}, {}, 7, 4};
    const cv::Rect region(7, 4, 21, 12);
    for (const Eye eye : {Eye::left, Eye::right}) {
        Image<std::uint8_t> found(region.width, region.height, 99);
        reference::rectify(source.raw, eye, rectifier, found.plane(), found.rows());
        expect_equal(luma(source.eye(eye), GetParam())(region), found);
    }
    for (const Eye eye : {Eye::left, Eye::right}) {
        Image<std::uint8_t> found(3 * region.width, region.height, 99);
        reference::rectify_colour(source.raw, eye, rectifier, found.plane(), found.rows());
        expect_equal(colour(source.eye(eye), GetParam())(region), found);
    }
}

TEST_P(Rectify, WritesOnlyItsRows) {
    Random random(3);
    Source source(random, GetParam());
    const Maps maps(random, 20, 10);
    const Rectifier rectifier{true, maps.view(), maps.view()};
    Image<std::uint8_t> whole(20, 10, 99);
    Image<std::uint8_t> part(20, 10, 99);
    reference::rectify(source.raw, Eye::left, rectifier, whole.plane(), whole.rows());
    reference::rectify(source.raw, Eye::left, rectifier, part.plane(), {3, 5});
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 20; ++x) {
            EXPECT_EQ(part.at(x, y), y == 3 || y == 4 ? whole.at(x, y) : 99);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, Rectify, testing::Values(PixelFormat::grey8, PixelFormat::yuyv, PixelFormat::bgr24),
                         [](const auto& instance) {
                             return instance.param == PixelFormat::grey8  ? "grey8"
                                    : instance.param == PixelFormat::yuyv ? "yuyv"
                                                                          : "bgr24";
                         });

TEST(RectifyByHand, WeighsFourPixelsAndCountsTheOutsideAsBlack) {
    Image<std::uint8_t> bytes(4, 2, {10, 20, 0, 0, 30, 41, 0, 0});
    const RawImage raw{bytes.plane().data, PixelFormat::grey8, 2, 2, 4};
    // The middle of the four, a point on the upper edge half outside, one far away.
    std::vector<std::int16_t> xy = {0, 0, 0, -1, 500, -500};
    std::vector<std::uint16_t> fraction = {16 * 32 + 16, 16 * 32, 0};
    const Rectifier rectifier{true, {{xy.data(), 6, 1, 6}, {fraction.data(), 3, 1, 3}}, {}};
    Image<std::uint8_t> out(3, 1);
    reference::rectify(raw, Eye::left, rectifier, out.plane(), out.rows());
    EXPECT_EQ(out.pixels(), (std::vector<std::uint8_t>{25, 5, 0}));
}

TEST(RectifyColour, EveryYuvValueEqualsOpenCv) {
    // All of u and v, and luma in steps that meet both ends of its range.
    for (int luma_value = 0; luma_value < 256; luma_value += 15) {
        Image<std::uint8_t> bytes(2 * 2 * 512, 256);
        for (int v = 0; v < 256; ++v) {
            for (int u = 0; u < 256; ++u) {
                std::uint8_t* pair = &bytes.at(4 * u, v);
                pair[0] = static_cast<std::uint8_t>(luma_value);
                pair[1] = static_cast<std::uint8_t>(u);
                pair[2] = static_cast<std::uint8_t>(255 - luma_value);
                pair[3] = static_cast<std::uint8_t>(v);
            }
        }
        const RawImage raw{bytes.plane().data, PixelFormat::yuyv, 512, 256, 2048};
        Image<std::uint8_t> found(3 * 512, 256);
        reference::rectify_colour(raw, Eye::left, {}, found.plane(), found.rows());
        cv::Mat expected;
        cv::cvtColor(cv::Mat(256, 512, CV_8UC2, bytes.plane().data, 2048), expected, cv::COLOR_YUV2BGR_YUYV);
        expect_equal(expected, found);
    }
}

}  // namespace
}  // namespace disparityd::test
