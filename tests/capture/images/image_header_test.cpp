// SPDX-License-Identifier: Apache-2.0
//
// The size of an image is known, and refused where it is too large, before anything is decoded.
#include <sstream>

#include "capture/images/image_files.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"
#include "tools/datasets/dataset.h"

namespace disparityd::capture {
namespace {

using test::numbered_image;
using test::refusal;
using test::TemporaryFolder;
using test::write_image;
using testing::AllOf;
using testing::HasSubstr;

std::string big_endian(std::uint32_t number, int size = 4) {
    std::string bytes;
    for (int i = size - 1; i >= 0; --i) {
        bytes += static_cast<char>(number >> (8 * i));
    }
    return bytes;
}

std::string little_endian(std::uint32_t number, int size = 4) {
    const std::string bytes = big_endian(number, size);
    return {bytes.rbegin(), bytes.rend()};
}

std::optional<ImageSize> header(const std::string& bytes) {
    std::istringstream file(bytes);
    return read_image_header(file);
}

std::string tiff(std::initializer_list<std::pair<int, std::uint32_t>> entries) {
    std::string bytes =
        "II*" + std::string(1, '\0') + little_endian(8) + little_endian(static_cast<std::uint32_t>(entries.size()), 2);
    for (const auto& [tag, value] : entries) {
        bytes += little_endian(static_cast<std::uint32_t>(tag), 2) + little_endian(4, 2) + little_endian(1) +
                 little_endian(value);
    }
    return bytes + little_endian(0);
}

/// Headers of 30000 x 20000 pixels, with nothing behind them.
std::map<std::string, std::string> huge_headers() {
    const std::string zero(1, '\0');
    const std::string jpeg_frame =
        "\xff\xc2" + big_endian(17, 2) + "\x08" + big_endian(20000, 2) + big_endian(30000, 2);
    return {
        {"0.png",
         "\x89PNG\r\n\x1a\n" + big_endian(13) + "IHDR" + big_endian(30000) + big_endian(20000) + std::string(9, '\1')},
        {"0.pgm", "P5\n# a comment\n30000 20000\n255\n"},
        {"0.ppm", "P6 30000\n20000 255 "},
        {"0.pfm", "Pf\n30000 20000\n-1\n"},
        {"0.jpg", "\xff\xd8\xff\xe0" + big_endian(4, 2) + "ab" + "\xff" + jpeg_frame},
        {"0.bmp", "BM" + std::string(12, '\0') + little_endian(40) + little_endian(30000) + little_endian(0U - 20000U)},
        {"0.tif", tiff({{256, 30000}, {257, 20000}})},
        {"1.tif", "MM" + zero + "*" + big_endian(8) + big_endian(2, 2) + big_endian(256, 2) + big_endian(3, 2) +
                      big_endian(1) + big_endian(30000, 2) + big_endian(0, 2) + big_endian(257, 2) + big_endian(4, 2) +
                      big_endian(1) + big_endian(20000) + big_endian(0)},
        {"0.webp", "RIFF" + little_endian(100) + "WEBPVP8X" + little_endian(10) + little_endian(0) +
                       little_endian(29999, 3) + little_endian(19999, 3)},
    };
}

TEST(ImageHeader, SaysTheSizeOfWhatCanBeWritten) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg", "a.pgm", "a.bmp", "a.tif", "a.webp", "a.pbm"}) {
        write_image(folder.file(name), numbered_image(37, 21, CV_8UC1, 1));
        EXPECT_EQ(peek_image_size(folder.file(name)), (ImageSize{37, 21})) << name;
        EXPECT_EQ(decode_image(folder.file(name)).size(), cv::Size(37, 21)) << name;
    }
    write_image(folder.file("a.ppm"), numbered_image(37, 21, CV_8UC3, 1));
    EXPECT_EQ(peek_image_size(folder.file("a.ppm")), (ImageSize{37, 21}));
    write_image(folder.file("a.pfm"), cv::Mat(21, 37, CV_32FC1, cv::Scalar(1)));
    EXPECT_EQ(peek_image_size(folder.file("a.pfm")), (ImageSize{37, 21}));
    for (const int quality : {50, 101}) {  // with loss, and without
        ASSERT_TRUE(cv::imwrite(folder.file("b.webp"), numbered_image(37, 21, CV_8UC3, 1),
                                {cv::IMWRITE_WEBP_QUALITY, quality}));
        EXPECT_EQ(peek_image_size(folder.file("b.webp")), (ImageSize{37, 21})) << quality;
    }
}

TEST(ImageHeader, AHugeOneIsRefusedBeforeItIsDecoded) {
    const TemporaryFolder folder;
    for (const auto& [name, bytes] : huge_headers()) {
        const std::string path = folder.write(name, bytes);
        EXPECT_EQ(peek_image_size(path), (ImageSize{30000, 20000})) << name;
        // The pixels are not there: who decodes first finds damage.
        EXPECT_THAT(refusal([&] { decode_image(path); }),
                    AllOf(HasSubstr(name), HasSubstr("found 30000x20000 pixels"), HasSubstr("8192")));
    }
    const std::string tiles = folder.write("t.tif", tiff({{256, 64}, {257, 64}, {322, 1U << 30U}, {323, 16}}));
    EXPECT_THAT(refusal([&] { decode_image(tiles); }), HasSubstr("found 1073741824x64 pixels"));
    for (const auto& twice : {tiff({{256, 30000}, {257, 20000}, {256, 16}, {257, 16}}),
                              tiff({{256, 16}, {257, 16}, {256, 30000}, {257, 20000}})}) {
        EXPECT_EQ(header(twice), (ImageSize{30000, 20000})) << "decoders may take either";
    }
}

TEST(ImageHeader, GroundTruthAndMasksAreLookedAtInTheSameWay) {
    const TemporaryFolder folder;
    write_image(folder.file("left.png"), numbered_image(8, 4, CV_8UC1, 1));
    write_image(folder.file("right.png"), numbered_image(8, 4, CV_8UC1, 2));
    const std::string huge = folder.write("huge.png", huge_headers().at("0.png"));
    datasets::DatasetScene scene{"scene", folder.file("left.png"), folder.file("right.png"), huge, {}, {}, 4};
    EXPECT_THAT(refusal([&] { datasets::read_ground_truth(scene); }), HasSubstr("huge.png: found 30000x20000"));
    scene.truth = folder.file("left.png");
    scene.mask = huge;
    EXPECT_THAT(refusal([&] { datasets::read_ground_truth(scene); }), HasSubstr("huge.png: found 30000x20000"));
    scene.truth = folder.write("short.pfm", "Pf\n8000 8000\n-1\nabcd");
    EXPECT_THAT(refusal([&] { datasets::read_ground_truth(scene); }), HasSubstr("short.pfm: found 20 bytes in all"));
}

TEST(ImageHeader, WhatIsCutOffOrNoImageHasNoSize) {
    for (const auto& [name, bytes] : huge_headers()) {
        for (std::size_t length = 0; length < bytes.size() - 14; ++length) {
            EXPECT_EQ(header(bytes.substr(0, length)), std::nullopt) << name << " cut to " << length << " bytes";
        }
    }
    EXPECT_EQ(header("P9 3 4 255 "), std::nullopt);
    EXPECT_EQ(header("GIF89a" + std::string(60, '\1')), std::nullopt);
    EXPECT_EQ(header("P5 " + std::string(600, '1')), (ImageSize{2147483647, 2147483647}));
    EXPECT_EQ(header(tiff({{256, 30000}})), std::nullopt);
    const std::string jpeg = huge_headers().at("0.jpg");
    const std::string filled = "\xff\xd8" + std::string(100'000, '\xff') + jpeg.substr(3);
    EXPECT_EQ(header(filled), std::nullopt) << "nobody fills up with so many bytes, and each would cost a seek";
}

}  // namespace
}  // namespace disparityd::capture
