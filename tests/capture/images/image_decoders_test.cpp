// SPDX-License-Identifier: Apache-2.0
//
// Each kind of image file against OpenCV's own decoders, and as it is when bytes of it have changed.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <png.h>
#include <tiffio.h>

#include "capture/images/image_files.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::refusal;
using test::TemporaryFolder;
using test::write_file;
using testing::HasSubstr;

cv::Mat random_image(int width, int height, int type, unsigned seed = 7) {
    cv::Mat image(height, width, type);
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < image.total() * image.elemSize(); ++i) {
        image.data[i] = static_cast<std::uint8_t>(random());
    }
    return image;
}

void expect_as_opencv(const std::string& path) {
    const cv::Mat theirs = cv::imread(path, cv::IMREAD_UNCHANGED);
    ASSERT_FALSE(theirs.empty()) << path;
    const cv::Mat ours = decode_image(path);
    ASSERT_EQ(ours.type(), theirs.type()) << path;
    ASSERT_EQ(ours.size(), theirs.size()) << path;
    EXPECT_EQ(cv::norm(ours, theirs, cv::NORM_INF), 0) << path;
}

struct Written {
    const char* name;
    int type;
    std::vector<int> parameters = {};
};

std::vector<Written> written_kinds() {
    std::vector<Written> kinds;
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
        kinds.push_back({"a.png", type});
        kinds.push_back({type == CV_8UC1 || type == CV_16UC1 ? "a.pgm" : "a.ppm", type});
        for (const int compression : {1, 5, 8}) {  // none, LZW, deflate
            kinds.push_back({"a.tif", type, {cv::IMWRITE_TIFF_COMPRESSION, compression}});
        }
    }
    for (const int type : {CV_8UC4, CV_16UC4}) {
        kinds.push_back({"b.png", type});
        kinds.push_back({"b.tif", type});
    }
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4}) {
        kinds.push_back({"a.bmp", type});
    }
    for (const int quality : {70, 101}) {  // 101: without loss
        kinds.push_back({"a.webp", CV_8UC3, {cv::IMWRITE_WEBP_QUALITY, quality}});
        kinds.push_back({"b.webp", CV_8UC4, {cv::IMWRITE_WEBP_QUALITY, quality}});
    }
    kinds.push_back({"a.pbm", CV_8UC1});
    for (const char* text : {"t.pgm", "t.ppm", "t.pbm"}) {
        kinds.push_back({text, text[2] == 'p' && text[3] == 'p' ? CV_8UC3 : CV_8UC1, {cv::IMWRITE_PXM_BINARY, 0}});
    }
    return kinds;
}

TEST(ImageDecoders, WhatOpenCvWritesIsReadAsOpenCvReadsIt) {
    const TemporaryFolder folder;
    for (const Written& kind : written_kinds()) {
        for (const cv::Size size : {cv::Size(37, 21), cv::Size(1, 1), cv::Size(64, 3)}) {
            const std::string path = folder.file(kind.name);
            cv::Mat image = random_image(size.width, size.height, kind.type);
            if (image.type() == CV_8UC4) {
                cv::Mat opaque(size, CV_8UC1, cv::Scalar(255));  // libtiff multiplies colours with what shines through
                cv::insertChannel(opaque, image, 3);
            }
            ASSERT_TRUE(cv::imwrite(path, image, kind.parameters)) << kind.name;
            expect_as_opencv(path);
        }
    }
}

/// Writes a PNG of random bytes in a way that OpenCV does not write.
void write_png(const std::string& path, cv::Size size, int bits, int colours, bool interlaced, bool transparent) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file.get());
    png_set_IHDR(png, info, static_cast<png_uint_32>(size.width), static_cast<png_uint_32>(size.height), bits, colours,
                 interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (colours == PNG_COLOR_TYPE_PALETTE) {
        std::vector<png_color> palette;
        std::vector<png_byte> alpha;
        for (int i = 0; i < 1 << bits; ++i) {
            palette.push_back({static_cast<png_byte>(3 * i), static_cast<png_byte>(i), static_cast<png_byte>(255 - i)});
            alpha.push_back(static_cast<png_byte>(7 * i));
        }
        png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
        if (transparent) {
            png_set_tRNS(png, info, alpha.data(), static_cast<int>(alpha.size()), nullptr);
        }
    } else if (transparent) {
        png_color_16 colour{};
        colour.red = colour.green = colour.blue = colour.gray = 1;
        png_set_tRNS(png, info, nullptr, 0, &colour);
    }
    png_write_info(png, info);
    const std::size_t row_bytes = png_get_rowbytes(png, info);
    cv::Mat rows = random_image(static_cast<int>(row_bytes), size.height, CV_8UC1);
    std::vector<png_bytep> pointers;
    for (int y = 0; y < size.height; ++y) {
        pointers.push_back(rows.ptr(y));
    }
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
}

TEST(ImageDecoders, EveryKindOfPngIsReadAsOpenCvReadsIt) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.png");
    for (const int bits : {1, 2, 4, 8, 16}) {
        for (const int colours : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_RGB,
                                  PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB_ALPHA}) {
            const bool allowed =
                colours == PNG_COLOR_TYPE_GRAY || (colours == PNG_COLOR_TYPE_PALETTE ? bits <= 8 : bits >= 8);
            for (int variant = 0; allowed && variant < 4; ++variant) {
                const bool transparent = (variant & 2) != 0;
                if (transparent && (colours & PNG_COLOR_MASK_ALPHA) != 0) {
                    continue;  // the two exclude each other
                }
                SCOPED_TRACE(testing::Message() << bits << " bits, colours " << colours << ", variant " << variant);
                write_png(path, {19, 11}, bits, colours, (variant & 1) != 0, transparent);
                expect_as_opencv(path);
            }
        }
    }
}

/// Writes a TIFF in tiles of 16 x 16 random pixels.
void write_tiles(const std::string& path, std::uint32_t width, std::uint32_t height, int bits, int channels) {
    TIFF* const tiff = TIFFOpen(path.c_str(), "w");
    ASSERT_NE(tiff, nullptr);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, channels);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
    for (std::uint32_t number = 0; number < TIFFNumberOfTiles(tiff); ++number) {
        cv::Mat tile = random_image(16 * bits / 8 * channels, 16, CV_8UC1, number);
        EXPECT_GT(TIFFWriteEncodedTile(tiff, number, tile.data, static_cast<tmsize_t>(tile.total())), 0);
    }
    TIFFClose(tiff);
}

TEST(ImageDecoders, TiffInTilesIsReadAsOpenCvReadsIt) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.tif");
    for (const int bits : {8, 16}) {
        for (const int channels : {1, 3}) {
            write_tiles(path, 40, 33, bits, channels);
            expect_as_opencv(path);
        }
    }
}

/// A TIFF of the size 16 x 16 without pixels, whose tags a file of a few hundred bytes can state.
void write_claims(const std::string& path, std::uint32_t side, int channels, std::uint32_t tile) {
    TIFF* const tiff = TIFFOpen(path.c_str(), "w");
    ASSERT_NE(tiff, nullptr);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, side);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, side);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, channels);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
    std::uint8_t nothing = 0;
    if (tile > 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, tile);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, tile);
        EXPECT_EQ(TIFFWriteRawTile(tiff, 0, &nothing, 1), 1);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, side);
        EXPECT_EQ(TIFFWriteRawStrip(tiff, 0, &nothing, 1), 1);
    }
    TIFFClose(tiff);
}

TEST(ImageDecoders, ATiffThatClaimsGigabytesIsRefusedBeforeItIsDecoded) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.tif");
    write_claims(path, 4096, 60, 0);
    EXPECT_THAT(refusal([&] { decode_image(path); }), HasSubstr("says no size that is taken"));
    write_claims(path, 16, 60, 0);
    EXPECT_THAT(refusal([&] { decode_image(path); }), HasSubstr("a TIFF of 60 channels, unsigned"));
    write_claims(path, 16, 1, 32768);
    EXPECT_THAT(refusal([&] { decode_image(path); }), HasSubstr("allowed are up to 8192"));
}

TEST(ImageDecoders, NumbersAsTextAreScaledToWhatTheFileStatesAsLargest) {
    const TemporaryFolder folder;
    for (const char* text : {"P2\n6 1\n100\n7 1 2 3 99 50\n", "P3\n2 1\n100\n7 1 2 3 99 50\n",
                             "P2\n3 1\n500\n7 1 501\n", "P1\n5 2\n01101\n1 0 0 1 1\n",
                             "P2 # a comment\n2 1 # another\n15\n15 17\n", "P2\n2 1\n255\n# made 2024\n1 2\n"}) {
        write_file(folder.file("a.pgm"), text);
        expect_as_opencv(folder.file("a.pgm"));
    }
    for (const std::string& text :
         {std::string("P5\n2 1\n15\n\x0f\x07"), std::string("P5\n2 1\n1023\n\x03\xff\0\x07", 16),
          std::string("P4\n12 1\n\x65\xf0")}) {
        write_file(folder.file("a.pgm"), text);
        expect_as_opencv(folder.file("a.pgm"));
    }
}

TEST(ImageDecoders, WhatIsNotReadIsRefusedInOneLine) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.tif");
    ASSERT_TRUE(cv::imwrite(path, cv::Mat(4, 4, CV_32FC1, cv::Scalar(1))));
    EXPECT_THAT(refusal([&] { decode_image(path); }), HasSubstr("found pixels of 32 bits (a TIFF of 1 channels"));
    ASSERT_TRUE(cv::imwrite(folder.file("a.pfm"), cv::Mat(4, 4, CV_32FC1, cv::Scalar(1))));
    EXPECT_THAT(refusal([&] { decode_image(folder.file("a.pfm")); }), HasSubstr("found floats (PFM)"));
    write_file(folder.file("a.pgm"), "P5\n0 4\n255\n");
    EXPECT_THAT(refusal([&] { decode_image(folder.file("a.pgm")); }), HasSubstr("says no size"));
    for (const char* text : {"P2\n2 1\n255\n1x2\n", "P2\n2 1\n255\n-5 7\n"}) {
        write_file(folder.file("a.pgm"), text);
        EXPECT_THAT(refusal([&] { decode_image(folder.file("a.pgm")); }), HasSubstr("no number"));
    }
    std::string bmp("BM\0\0\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\x08\0\0\0\x01\0\0\0\x01\0\x01", 29);
    bmp.resize(66, '\0');
    write_file(folder.file("a.bmp"), bmp);
    EXPECT_THAT(refusal([&] { decode_image(folder.file("a.bmp")); }), HasSubstr("found a BMP of 1 bits"));
}

// Whatever a damaged file says, it is read or refused, and nothing is written to stderr.
TEST(ImageDecoders, ChangedBytesAreReadOrRefusedWithoutAWord) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    for (const Written& kind : written_kinds()) {
        const std::string path = folder.file(kind.name);
        ASSERT_TRUE(cv::imwrite(path, random_image(13, 9, kind.type), kind.parameters));
        std::ifstream file(path, std::ios::binary);
        const std::string whole{std::istreambuf_iterator<char>(file), {}};
        testing::internal::CaptureStderr();
        for (int i = 0; i < 60; ++i) {
            std::string bytes = whole.substr(0, i % 3 == 0 ? 1 + random() % whole.size() : whole.size());
            for (int change = i % 4; change > 0; --change) {
                bytes[random() % bytes.size()] = static_cast<char>(random());
            }
            try {
                decode_image({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "changed");
            } catch (const std::invalid_argument& refused) {
                EXPECT_EQ(std::string(refused.what()).find('\n'), std::string::npos) << refused.what();
            } catch (const std::runtime_error& refused) {
                EXPECT_THAT(refused.what(), HasSubstr("not enough memory"));
            }
        }
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << kind.name;
    }
}

}  // namespace
}  // namespace disparityd::capture
