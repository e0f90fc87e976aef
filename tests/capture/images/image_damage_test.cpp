// SPDX-License-Identifier: Apache-2.0
//
// Images that were cut off, whose bits have changed, or that declare to be turned: refused in one line of ours, and
// nothing of a decoder beside it.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "capture/images/image_files.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::refusal;
using test::TemporaryFolder;
using test::write_file;
using test::write_image;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

cv::Mat noise(int width, int height, int type) {
    cv::Mat image(height, width, type);
    std::mt19937 random(5);
    for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
        image.data[i] = static_cast<std::uint8_t>(96 + random() % 64);
    }
    return image;
}

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The refusal, where nothing else was written to stderr.
std::string refused(const std::string& path) {
    testing::internal::CaptureStderr();
    const std::string said = refusal([&] { decode_image(path); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    return said;
}

TEST(ImageDamage, AJpegThatWasCutOffIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.jpg");
    for (const int type : {CV_8UC1, CV_8UC3}) {
        write_image(path, noise(64, 48, type));
        EXPECT_EQ(decode_image(path).type(), type);
        const std::string whole = bytes_of(path);
        for (const std::size_t part : {60U, 90U}) {
            write_file(path, whole.substr(0, whole.size() * part / 100));
            EXPECT_THAT(refused(path), AllOf(StartsWith(path + ": is damaged: "), HasSubstr("Premature end")));
        }
    }
}

TEST(ImageDamage, AJpegWithAHoleIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.jpg");
    write_image(path, noise(64, 48, CV_8UC3));
    std::string bytes = bytes_of(path);
    for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 64; ++i) {
        bytes[i] = '\xff';
    }
    write_file(path, bytes);
    EXPECT_THAT(refused(path), StartsWith(path + ": is damaged: "));
}

TEST(ImageDamage, AJpegIsDecodedAsOpenCvDoes) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.jpg");
    for (const int type : {CV_8UC1, CV_8UC3}) {
        write_image(path, noise(50, 31, type));
        const cv::Mat theirs = cv::imread(path, cv::IMREAD_UNCHANGED);
        EXPECT_LE(cv::norm(decode_image(path), theirs, cv::NORM_INF), 2) << "another version of libjpeg may round";
    }
}

TEST(ImageDamage, APngWithAFlippedBitOrCutOffIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.png");
    write_image(path, noise(64, 48, CV_8UC1));
    const std::string whole = bytes_of(path);
    for (std::size_t at = 60; at + 20 < whole.size(); at += 397) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 4);
        write_file(path, bytes);
        EXPECT_THAT(refused(path), StartsWith(path + ": is damaged: "));
    }
    write_file(path, whole.substr(0, whole.size() - 12));  // without its end
    EXPECT_THAT(refused(path), HasSubstr("cut off"));
}

// libpng warns of profiles and other things that say nothing about the pixels.
TEST(ImageDamage, APngWithAnOddProfileIsReadWithoutAWord) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.png");
    const cv::Mat image = noise(16, 8, CV_8UC3);
    write_image(path, image);
    std::string bytes = bytes_of(path);
    const std::string profile("\0\0\0\x0ciCCPodd\0\0abcdefg????", 24);  // its checksum is wrong, too
    bytes.insert(33, profile);
    write_file(path, bytes);
    testing::internal::CaptureStderr();
    EXPECT_EQ(cv::norm(decode_image(path), image, cv::NORM_INF), 0);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ImageDamage, APgmOrABmpThatWasCutOffIsRefused) {
    const TemporaryFolder folder;
    for (const auto& [name, type] :
         {std::pair("a.pgm", CV_8UC1), std::pair("a.ppm", CV_8UC3), std::pair("b.pgm", CV_16UC1),
          std::pair("a.bmp", CV_8UC3), std::pair("b.bmp", CV_8UC1)}) {
        const std::string path = folder.file(name);
        write_image(path, noise(20, 10, type));
        EXPECT_EQ(decode_image(path).type(), type);
        const std::string whole = bytes_of(path);
        write_file(path, whole.substr(0, whole.size() - 7));
        EXPECT_THAT(refused(path), AllOf(StartsWith(path + ": is damaged: the file was cut off"),
                                         HasSubstr(std::to_string(whole.size()) + " bytes are there")));
    }
}

TEST(ImageDamage, ABitmapThatWasCutOffIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.ppm");
    const std::string whole = "P4\n12 3\n" + std::string(6, '\xa5');
    write_file(path, whole);
    EXPECT_EQ(decode_image(path).cols, 12);
    write_file(path, whole.substr(0, whole.size() - 1));
    EXPECT_THAT(refused(path), HasSubstr("13 of 14 bytes are there"));
}

TEST(ImageDamage, NumbersAsTextAreReadToTheLastOne) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.ppm");
    for (const auto& [head, count] : {std::pair("P2\n4 3\n255\n", 12), {"P3\n2 2\n255\n", 12}, {"P1\n4 3\n", 12}}) {
        std::string text = head;
        for (int i = 0; i + 1 < count; ++i) {
            text += text[1] == '1' ? "1" : std::to_string(20 * i) + (i % 4 == 3 ? "\n" : " ");
        }
        write_file(path, text);
        EXPECT_THAT(refused(path), HasSubstr("cut off, values are missing"));
        write_file(path, text + (text[1] == '1' ? "0" : "255"));  // no line end behind it
        const cv::Mat image = decode_image(path);
        EXPECT_EQ(image.data[image.total() * image.elemSize() - (image.channels() == 1 ? 1 : 3)], 255);
    }
}

/// EXIF data that hold one tag: the orientation.
std::string exif(char orientation, bool big_endian) {
    if (big_endian) {
        return std::string("MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0", 19) + orientation + std::string(6, '\0');
    }
    return std::string("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 18) + orientation + std::string(7, '\0');
}

TEST(ImageDamage, AnOrientationIsObeyedOrRefused) {
    const TemporaryFolder folder;
    const std::string jpeg = folder.file("a.jpg");
    write_image(jpeg, noise(16, 8, CV_8UC1));
    const std::string plain = bytes_of(jpeg);
    for (const char orientation : {'\1', '\3', '\6', '\x8'}) {
        for (const bool big_endian : {false, true}) {
            const std::string data = std::string("Exif\0\0", 6) + exif(orientation, big_endian);
            const auto size = static_cast<char>(data.size() + 2);
            write_file(jpeg, plain.substr(0, 2) + std::string("\xff\xe1\0", 3) + size + data + plain.substr(2));
            if (orientation == '\1') {
                EXPECT_EQ(decode_image(jpeg).cols, 16);
            } else {
                EXPECT_THAT(refused(jpeg), HasSubstr("orientation " + std::to_string(int{orientation})));
            }
        }
    }
    const std::string png = folder.file("a.png");
    write_image(png, noise(16, 8, CV_8UC1));
    std::string bytes = bytes_of(png);
    const std::string data = exif('\6', true);
    bytes.insert(33, std::string("\0\0\0", 3) + static_cast<char>(data.size()) + "eXIf" + data + "????");
    write_file(png, bytes);
    EXPECT_THAT(refused(png), HasSubstr("orientation 6"));
}

}  // namespace
}  // namespace disparityd::capture
