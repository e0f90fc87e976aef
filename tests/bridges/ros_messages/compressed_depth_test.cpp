// SPDX-License-Identifier: Apache-2.0
//
// Compressed depths, against OpenCV's decoder of PNG and one of RVL that shares nothing with the encoder.
#include <cstring>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "bridges/ros_messages/compressed_depth_message.h"
#include "tests/bridges/ros_messages/cdr_reader.h"
#include "tests/bridges/ros_messages/message_frames.h"

namespace disparityd::ros {
namespace {

using disparity::Frame;
using disparity::Product;
using test::CdrReader;
using Octets = std::vector<std::uint8_t>;
using Depths = std::vector<std::uint16_t>;

Frame frame_of(std::uint32_t width, const Depths& depths) {
    Frame frame = test::bare_frame();
    Octets bytes(2 * depths.size());
    std::memcpy(bytes.data(), depths.data(), bytes.size());
    const auto height = static_cast<std::uint32_t>(depths.size() / width);
    frame.planes = {{Product::depth, width, height, 2, std::move(bytes)}};
    return frame;
}

/// Returns what stands behind the transport's 12 bytes.
Octets picture_in(const std::optional<std::string>& message, const std::string& format) {
    CdrReader cdr(message.value());
    EXPECT_EQ(cdr.header(), "1700000000.123456789 left_camera");
    EXPECT_EQ(cdr.text(), format);
    const Octets data = cdr.sequence<std::uint8_t>();
    EXPECT_EQ(cdr.left(), 0U);
    EXPECT_EQ(Octets(data.begin(), data.begin() + 12), Octets(12)) << "INV_DEPTH and no parameters";
    return {data.begin() + 12, data.end()};
}

Octets png_of(const Frame& frame) {
    return picture_in(compressed_depth(frame, DepthCodec::png), "16UC1; compressedDepth png");
}

Octets rvl_of(const Frame& frame) {
    return picture_in(compressed_depth(frame, DepthCodec::rvl), "16UC1; compressedDepth rvl");
}

std::uint32_t u32_at(const Octets& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes.at(at), sizeof value);
    return value;
}

/// Reads RVL from the text of its nibbles.
class RvlText {
public:
    explicit RvlText(const Octets& bytes) {
        for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4) {
            char word[9];
            std::snprintf(word, sizeof word, "%08x", u32_at(bytes, at));
            digits_ += word;
        }
    }

    std::uint32_t number() {
        std::uint64_t value = 0;
        for (int shift = 0;; shift += 3) {
            const int nibble = std::stoi(digits_.substr(at_++, 1), nullptr, 16);
            value += std::uint64_t(nibble % 8) << shift;
            if (nibble < 8) {
                return static_cast<std::uint32_t>(value);
            }
        }
    }

    Depths depths(std::size_t count) {
        Depths all;
        int last = 0;
        while (all.size() < count) {
            all.resize(all.size() + number());
            for (std::uint32_t left = number(); left > 0; --left) {
                const std::uint32_t code = number();
                last += code % 2 == 1 ? -static_cast<int>(code / 2) - 1 : static_cast<int>(code / 2);
                all.push_back(static_cast<std::uint16_t>(last));
            }
        }
        return all;
    }

    /// Whether nothing but the zeros of a last word is left.
    bool at_end() const { return digits_.size() - at_ < 8 && digits_.find_first_not_of('0', at_) == std::string::npos; }

private:
    std::string digits_;
    std::size_t at_ = 0;
};

void expect_both_give(std::uint32_t width, const Depths& depths) {
    const Frame frame = frame_of(width, depths);
    const auto height = static_cast<std::uint32_t>(depths.size() / width);
    const cv::Mat png = cv::imdecode(png_of(frame), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(png.type(), CV_16UC1);
    ASSERT_EQ(png.size(), cv::Size(static_cast<int>(width), static_cast<int>(height)));
    EXPECT_TRUE(Depths(png.begin<std::uint16_t>(), png.end<std::uint16_t>()) == depths);
    const Octets rvl = rvl_of(frame);
    EXPECT_EQ(u32_at(rvl, 0), width);
    EXPECT_EQ(u32_at(rvl, 4), height);
    RvlText text(Octets(rvl.begin() + 8, rvl.end()));
    EXPECT_TRUE(text.depths(depths.size()) == depths);
    EXPECT_TRUE(text.at_end());
}

TEST(RosCompressedDepth, RandomPicturesComeBack) {
    std::mt19937 random(17);
    const auto below = [&random](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
    for (int i = 0; i < 40; ++i) {
        const std::uint32_t width = 1 + below(70);
        Depths depths(std::size_t{width} * (1 + below(50)));
        const std::uint32_t zeros_in_16 = below(17);
        for (std::uint16_t& depth : depths) {
            depth = below(16) < zeros_in_16 ? 0 : static_cast<std::uint16_t>(below(65536));
        }
        expect_both_give(width, depths);
    }
}

TEST(RosCompressedDepth, ExtremePicturesComeBack) {
    for (const Depths& repeated : {Depths{0}, {65535}, {1}, {0, 65535}, {65535, 0}, {1, 65535}, {32768, 32767, 0}}) {
        for (const std::size_t pixels : {1U, 7U, 64U, 4096U}) {
            Depths depths;
            for (std::size_t i = 0; i < pixels; ++i) {
                depths.push_back(repeated[i % repeated.size()]);
            }
            expect_both_give(1, depths);
            expect_both_give(static_cast<std::uint32_t>(pixels), depths);
        }
    }
}

TEST(RosCompressedDepth, ASmoothPictureIsSmall) {
    Depths depths;
    for (std::uint16_t i = 0; i < 64 * 48; ++i) {
        depths.push_back(static_cast<std::uint16_t>(1000 + i % 64));
    }
    const Frame frame = frame_of(64, depths);
    EXPECT_LT(png_of(frame).size(), depths.size() / 2);
    EXPECT_LT(rvl_of(frame).size(), depths.size());
}

/// By hand: 2 zeros, 1 other, 1000 as 2000 = 3 * 512 + 7 * 64 + 2 * 8 + 0.
TEST(RosCompressedDepth, RvlIsAsPublished) {
    EXPECT_EQ(rvl_of(frame_of(3, {0, 0, 1000})), (Octets{3, 0, 0, 0, 1, 0, 0, 0, 0x00, 0xf3, 0x8a, 0x21}));
}

TEST(RosCompressedDepth, WithoutDepthsThereIsNone) {
    EXPECT_FALSE(compressed_depth(test::colour_frame(), DepthCodec::png));
    Frame broken = frame_of(2, {1, 2});
    broken.planes.front().bytes.pop_back();
    EXPECT_FALSE(compressed_depth(broken, DepthCodec::rvl));
}

}  // namespace
}  // namespace disparityd::ros
