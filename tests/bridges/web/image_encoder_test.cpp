// SPDX-License-Identifier: Apache-2.0
//
// Images, against OpenCV's decoders and zlib's, and depth against the reference kernel.
#include "bridges/web/images/image_encoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <zlib.h>

#include "bridges/frames/planes.h"
#include "bridges/web/images/colours.h"
#include "bridges/web/images/snapshot.h"
#include "kernels/reference/steps.h"

namespace disparityd::web {
namespace {

using disparity::PlaneData;
using disparity::Product;
using frames::depth_mm;
using frames::leave_out_broken_planes;

constexpr int width = 96;
constexpr int height = 64;

template <typename T>
PlaneData plane_of(Product product, const std::vector<T>& values) {
    PlaneData plane{product, width, height, sizeof(T), std::vector<std::uint8_t>(values.size() * sizeof(T))};
    std::memcpy(plane.bytes.data(), values.data(), plane.bytes.size());
    return plane;
}

class ImageEncoderTest : public ::testing::Test {
protected:
    ImageEncoderTest() {
        disparity::Frame& frame = live_.frame;
        frame.width = width;
        frame.height = height;
        frame.f = 300;
        frame.baseline_mm = 120;
        frame.d_min = 0;
        frame.disparities = 64;
        frame.invalid = -16;
        std::mt19937 random(5);
        for (std::int16_t& value : d16_) {
            value = static_cast<std::int16_t>(random() % 8 == 0 ? -16 : static_cast<int>(random() % 1024));
        }
        for (std::size_t i = 0; i < left_.size(); ++i) {
            left_[i] = static_cast<std::uint8_t>(2 * (i % width));
        }
        frame.planes = {plane_of(Product::disparity, d16_), plane_of(Product::left, left_)};
    }

    static cv::Mat decoded(const EncodedImage& image) {
        return cv::imdecode(std::vector<std::uint8_t>(image.bytes->begin(), image.bytes->end()), cv::IMREAD_UNCHANGED);
    }

    static std::string inflated(const std::string& packed, std::size_t bytes) {
        std::string whole(bytes, '\0');
        uLongf size = bytes;
        EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(whole.data()), &size,
                             reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
                  Z_OK);
        EXPECT_EQ(size, bytes);
        return whole;
    }

    LiveFrame live_;
    std::vector<std::int16_t> d16_ = std::vector<std::int16_t>(width * height);
    std::vector<std::uint8_t> left_ = std::vector<std::uint8_t>(width * height);
};

TEST_F(ImageEncoderTest, TheLeftImageComesThroughJpeg) {
    const auto image = encode(live_, {Image::left, Encoding::jpeg, 0, 95, std::nullopt});
    ASSERT_NE(image, nullptr);
    EXPECT_EQ(image->type, "u8");
    const cv::Mat picture = decoded(*image);
    ASSERT_EQ(picture.size(), cv::Size(width, height));
    ASSERT_EQ(picture.channels(), 1);
    for (int x = 0; x < width; ++x) {
        EXPECT_NEAR(picture.at<std::uint8_t>(10, x), 2 * x, 4);
    }
}

TEST_F(ImageEncoderTest, AnImageIsScaledToTheWidth) {
    const auto image = encode(live_, {Image::left, Encoding::jpeg, 40, 95, std::nullopt});
    EXPECT_EQ(decoded(*image).size(), cv::Size(40, 27));
    EXPECT_EQ(encode(live_, {Image::disparity, Encoding::jpeg, 40, 95, std::nullopt})->width, 40);
    EXPECT_EQ(encode(live_, {Image::left, Encoding::jpeg, 9999, 95, std::nullopt})->width, width);
}

TEST_F(ImageEncoderTest, EqualViewsAreEncodedOnce) {
    const ImageView view{Image::disparity, Encoding::jpeg, 48, 80, RangeM{0.5, 10}};
    const auto first = encode(live_, view);
    EXPECT_EQ(encode(live_, view), first);
    ImageView other = view;
    other.range = RangeM{0.5, 11};
    EXPECT_NE(encode(live_, other), first);
}

TEST_F(ImageEncoderTest, AllWidthsShareAFew) {
    const auto first = encode(live_, {Image::left, Encoding::jpeg, 40, 80, std::nullopt});
    for (int wanted = 1; wanted < 9999; ++wanted) {
        const auto image = encode(live_, {Image::left, Encoding::jpeg, wanted, 80, std::nullopt});
        EXPECT_LE(image->width, std::max(wanted, 16));
        if (wanted >= 40 && wanted < 80) {
            EXPECT_EQ(image, first) << wanted;
        }
    }
    EXPECT_EQ(live_.encoded.size(), 4U) << "16, 40, 80, and the whole one";
}

TEST_F(ImageEncoderTest, AllRangesOfColoursShareAFew) {
    ImageView view{Image::disparity, Encoding::jpeg, 0, 80, std::nullopt};
    const auto usual = encode(live_, view);
    for (int i = 0; i < 100; ++i) {
        view.range = RangeM{0.5 + 0.01 * i, 10};
        const auto image = encode(live_, view);
        EXPECT_EQ(image == usual, i >= 4) << i;
        EXPECT_EQ(image->near_m == usual->near_m, i >= 4) << "the image says which range it has";
    }
    view.range = RangeM{0.5, 10};
    EXPECT_NE(encode(live_, view), usual) << "those that came first keep theirs";
}

TEST_F(ImageEncoderTest, ValuesAreEncodedOnceForAllRanges) {
    const auto one = encode(live_, {Image::disparity, Encoding::deflate, 0, 80, RangeM{0.5, 10}});
    const auto other = encode(live_, {Image::disparity, Encoding::deflate, 0, 80, RangeM{0.5, 20}});
    EXPECT_EQ(one->bytes, other->bytes);
    EXPECT_NE(one->far_m, other->far_m);
}

TEST_F(ImageEncoderTest, AMissingProductIsNoImage) {
    EXPECT_EQ(encode(live_, {Image::confidence, Encoding::jpeg, 0, 80, std::nullopt}), nullptr);
    EXPECT_EQ(encode(live_, {Image::depth_error, Encoding::deflate, 0, 80, std::nullopt}), nullptr);
}

TEST_F(ImageEncoderTest, LosslessDisparityIsThePlane) {
    const auto image = encode(live_, {Image::disparity, Encoding::deflate, 10, 80, std::nullopt});
    EXPECT_EQ(image->type, "i16");
    EXPECT_EQ(image->width, width);
    const std::string whole = inflated(*image->bytes, 2 * d16_.size());
    EXPECT_EQ(std::memcmp(whole.data(), d16_.data(), whole.size()), 0);
}

TEST_F(ImageEncoderTest, LosslessDepthIsTheReferences) {
    const auto image = encode(live_, {Image::depth, Encoding::deflate, 0, 80, std::nullopt});
    const std::string whole = inflated(*image->bytes, 2 * d16_.size());
    std::vector<std::uint16_t> wanted(d16_.size());
    DepthScale scale;
    scale.k = std::llround(16 * live_.frame.f * live_.frame.baseline_mm);
    reference::depth({d16_.data(), width, height, width}, -16, scale, {wanted.data(), width, height, width},
                     {0, height});
    EXPECT_EQ(std::memcmp(whole.data(), wanted.data(), whole.size()), 0);
}

TEST_F(ImageEncoderTest, TheGridHasTheNearestDepthOfEachBlock) {
    const auto grid = depth_grid(live_, 8);
    EXPECT_EQ(depth_grid(live_, 5), grid) << "the next step that all share";
    ASSERT_EQ(grid->step, 8);
    ASSERT_EQ(grid->width, 12);
    ASSERT_EQ(grid->height, 8);
    const std::string whole = inflated(*grid->bytes, 2 * 12 * 8);
    for (int y = 0; y < grid->height; ++y) {
        for (int x = 0; x < grid->width; ++x) {
            std::uint16_t mm = 0;
            std::memcpy(&mm, whole.data() + 2 * (y * grid->width + x), 2);
            int nearest = 0;
            for (int row = 8 * y; row < std::min(8 * y + 8, height); ++row) {
                for (int column = 8 * x; column < std::min(8 * x + 8, width); ++column) {
                    const int one = depth_mm(live_.frame, d16_[static_cast<std::size_t>(row * width + column)]);
                    const bool known = one != 0 && one != 65535;
                    nearest = known && (nearest == 0 || one < nearest) ? one : nearest;
                }
            }
            EXPECT_EQ(mm, nearest) << x << ' ' << y;
        }
    }
    live_.frame.f = 0;
    EXPECT_EQ(depth_grid(live_, 8), nullptr);
}

TEST_F(ImageEncoderTest, ASnapshotsDisparityIsKittis) {
    const std::string png = png_of(live_, Image::disparity);
    const cv::Mat picture = cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(picture.type(), CV_16UC1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const int d16 = d16_[static_cast<std::size_t>(y * width + x)];
            EXPECT_EQ(picture.at<std::uint16_t>(y, x), d16 == -16 ? 0 : std::max(16 * d16, 1));
        }
    }
    live_.frame.d_min = -4;
    EXPECT_THROW(png_of(live_, Image::disparity), std::runtime_error);
}

TEST_F(ImageEncoderTest, APlyHasThePointsThatWereMeasured) {
    const std::string ply = ply_of(live_);
    const std::size_t end = ply.find("end_header\n") + 11;
    std::size_t points = 0;
    std::size_t first = 0;
    for (std::size_t i = d16_.size(); i-- > 0;) {
        points += d16_[i] > 0 ? 1 : 0;
        first = d16_[i] > 0 ? i : first;
    }
    EXPECT_NE(ply.find("element vertex " + std::to_string(points) + "\n"), std::string::npos);
    ASSERT_EQ(ply.size() - end, 15 * points);
    float z = 0;
    std::memcpy(&z, ply.data() + end + 8, sizeof z);
    EXPECT_FLOAT_EQ(z, static_cast<float>(300 * 0.12 / (d16_[first] / 16.0)));
    live_.frame.f = 0;
    EXPECT_THROW(ply_of(live_), std::runtime_error);
}

TEST_F(ImageEncoderTest, NearIsRedFarIsBlueRejectedIsBlack) {
    const DisparityColours colours(live_.frame, Image::disparity, std::nullopt);
    EXPECT_EQ(colours.of(-16), (Colour{0, 0, 0}));
    const Colour& near = colours.of(1023);
    const Colour& far = colours.of(64);
    EXPECT_GT(near[2], near[0]);
    EXPECT_GT(far[0], far[2]);
    // Values that no daemon sends have a colour, too.
    EXPECT_EQ(colours.of(32767), near);
    EXPECT_EQ(colours.of(-32768), (Colour{0, 0, 0}));
}

TEST_F(ImageEncoderTest, TheRangeOfDistancesSetsTheEnds) {
    // 300 px * 0.12 m = 36 px m: 1 m is 36 px, 9 m are 4 px.
    const DisparityColours disparity(live_.frame, Image::disparity, RangeM{1, 9});
    EXPECT_DOUBLE_EQ(disparity.low, 64);
    EXPECT_DOUBLE_EQ(disparity.high, 576);
    EXPECT_EQ(disparity.of(576), turbo().back());
    EXPECT_EQ(disparity.of(64), turbo().front());
    EXPECT_EQ(disparity.of(320), turbo()[128]);
    const DisparityColours depth(live_.frame, Image::depth, RangeM{1, 9});
    EXPECT_EQ(depth.of(576), turbo().back());
    EXPECT_EQ(depth.of(64), turbo().front());
    // 5 m, the middle of the distances, are 7.2 px.
    EXPECT_NEAR(turbo()[128][1], depth.of(115)[1], 3);
    EXPECT_DOUBLE_EQ(*depth.near_m, 1);
    EXPECT_DOUBLE_EQ(*depth.far_m, 9);
}

TEST_F(ImageEncoderTest, PlanesThatAreNotAsTheirProductSaysAreLeftOut) {
    disparity::Frame& frame = live_.frame;
    leave_out_broken_planes(frame);
    ASSERT_EQ(frame.planes.size(), 2U);
    frame.planes.push_back({Product::disparity, 2, 2, 1, {1, 2, 3, 4}});                   // of 8 bits
    frame.planes.push_back({Product::confidence, 2, 2, 1, {1, 2, 3}});                     // too short
    frame.planes.push_back({Product::left_colour, 0xFFFFFFFF, 0xFFFFFFFF, 3, {1, 2, 3}});  // too large to count
    frame.planes.push_back({static_cast<Product>(0), 1, 1, 1, {1}});
    frame.planes.push_back({static_cast<Product>(99), 1, 1, 1, {1}});
    frame.planes.push_back({Product::scan, 3, 1, 1, {1, 2, 3}});  // a record
    leave_out_broken_planes(frame);
    ASSERT_EQ(frame.planes.size(), 3U);
    EXPECT_EQ(frame.planes[1].product, Product::left);
    EXPECT_EQ(frame.planes[2].product, Product::scan);
}

TEST_F(ImageEncoderTest, MoreDisparitiesThanThereAreAreRefused) {
    live_.frame.disparities = 0x0FFFFFFF;
    EXPECT_THROW(encode(live_, {Image::disparity, Encoding::jpeg, 0, 80, std::nullopt}), std::runtime_error);
    live_.frame.disparities = 0xFFFFFFFF;
    EXPECT_THROW(encode(live_, {Image::depth, Encoding::deflate, 0, 80, std::nullopt}), std::runtime_error);
}

TEST_F(ImageEncoderTest, WithoutACalibrationDisparitiesStillHaveColours) {
    live_.frame.f = 0;
    for (const Image image : {Image::disparity, Image::depth}) {
        const DisparityColours colours(live_.frame, image, RangeM{1, 9});
        EXPECT_FALSE(colours.near_m);
        EXPECT_EQ(colours.of(1024), turbo().back());
        EXPECT_EQ(colours.of(0), turbo().front());
    }
}

}  // namespace
}  // namespace disparityd::web
