// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/capture/recording/file_size_limit.h"
#include "tools/images/colour_map.h"
#include "tools/images/disparity_file.h"
#include "tools/images/image_file.h"
#include "tools/images/picture.h"

namespace disparityd::images {
namespace {

constexpr float rejected = std::numeric_limits<float>::infinity();

class ImagesTest : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) / (std::string("images_test.") + test->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    std::filesystem::path folder_;
};

std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(ImagesTest, AFileIsReplacedAsAWholeOrNotAtAll) {
    const std::string name(250, 'n');  // as long as names can nearly be
    const std::vector<std::uint8_t> small(100, 'a');
    const std::vector<std::uint8_t> large(100'000, 'b');
    write_file(path(name), small);
    std::filesystem::permissions(path(name), std::filesystem::perms(0640));
    std::filesystem::create_symlink(name, path("link"));
    {
        const capture::test::FileSizeLimit full(50'000);
        EXPECT_THAT([&] { write_file(path("link"), large); },
                    testing::ThrowsMessage<std::runtime_error>(
                        testing::AllOf(testing::HasSubstr("link"), testing::HasSubstr("File too large"))));
        EXPECT_THROW(write_file(path("new"), large), std::runtime_error);
    }
    EXPECT_EQ(content(path(name)), std::string(100, 'a')) << "the old one is whole";
    write_file(path("link"), large);
    EXPECT_EQ(content(path(name)), std::string(100'000, 'b'));
    EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
    EXPECT_EQ(std::filesystem::status(path(name)).permissions(), std::filesystem::perms(0640));
    std::filesystem::create_symlink("made", path("ahead"));
    write_file(path("ahead"), small);
    EXPECT_EQ(content(path("made")), std::string(100, 'a')) << "what a link leads to is made";
    EXPECT_TRUE(std::filesystem::is_symlink(path("ahead")));
    const std::filesystem::directory_iterator files(folder_);
    EXPECT_EQ(std::distance(begin(files), end(files)), 4) << "nothing unfinished is left";
    write_file("/dev/null", large);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    EXPECT_THROW(write_file("/dev/full", small), std::runtime_error);
    EXPECT_THROW(write_file(path("absent/file"), small), std::runtime_error);
}

struct Sample {
    DisparityRange range;
    int width;
    int height;
    std::vector<std::int16_t> d16;

    DisparityMap map() const { return {{d16.data(), width, height, width}, range}; }
};

/// Every third pixel rejected, the others anywhere in the range.
Sample random_sample(DisparityRange range, int width, int height) {
    Sample sample{range, width, height, {}};
    std::mt19937 random(7);
    std::uniform_int_distribution<int> any(range.first * 16, (range.first + range.count - 1) * 16);
    for (int i = 0; i < width * height; ++i) {
        sample.d16.push_back(i % 3 == 0 ? invalid_disparity(range) : static_cast<std::int16_t>(any(random)));
    }
    return sample;
}

TEST_F(ImagesTest, PngHoldsDisparityTimes256) {
    const Sample sample{{0, 256}, 5, 1, {-16, 0, 1, 24, 255 * 16}};
    write_disparity_png(path("d.png"), sample.map());
    const cv::Mat stored = read_image(path("d.png"));
    ASSERT_EQ(stored.type(), CV_16UC1);
    EXPECT_THAT(std::vector<int>(stored.begin<std::uint16_t>(), stored.end<std::uint16_t>()),
                testing::ElementsAre(0, 1, 16, 384, 65280));
}

TEST_F(ImagesTest, PngClampsWhatItCannotHold) {
    const Sample sample{{-16, 512}, 3, 1, {-17 * 16, -5, 300 * 16}};
    EXPECT_FALSE(fits_png(sample.range));
    write_disparity_png(path("d.png"), sample.map());
    EXPECT_THAT(read_disparity_png(path("d.png")).values, testing::ElementsAre(rejected, 1 / 256.0F, 65535 / 256.0F));
}

TEST_F(ImagesTest, RangeThatFitsPng) {
    EXPECT_TRUE(fits_png({0, 256}));
    EXPECT_FALSE(fits_png({1, 256}));
    EXPECT_TRUE(fits_png({191, 64}));
    EXPECT_FALSE(fits_png({-1, 16}));
}

TEST_F(ImagesTest, PngRoundTrip) {
    const Sample sample = random_sample({1, 128}, 37, 11);
    write_disparity_png(path("d.png"), sample.map());
    const FloatMap back = read_disparity_png(path("d.png"));
    EXPECT_EQ(back.width, 37);
    EXPECT_EQ(back.height, 11);
    EXPECT_EQ(back.values, to_float(sample.map()).values);
}

TEST_F(ImagesTest, PfmRoundTripOfNegativeDisparities) {
    const Sample sample = random_sample({-100, 256}, 37, 11);
    write_disparity_pfm(path("d.pfm"), sample.map());
    const FloatMap back = read_disparity_pfm(path("d.pfm"));
    EXPECT_EQ(back.width, 37);
    EXPECT_EQ(back.height, 11);
    EXPECT_EQ(back.values, to_float(sample.map()).values);
}

TEST_F(ImagesTest, PfmIsLittleEndianAndBottomUp) {
    const Sample sample{{0, 16}, 1, 2, {32, -16}};
    write_disparity_pfm(path("d.pfm"), sample.map());
    std::ifstream file(path("d.pfm"), std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const std::string expected("Pf\n1 2\n-1.0\n\x00\x00\x80\x7f\x00\x00\x00\x40", 20);
    EXPECT_EQ(bytes, expected);
}

TEST_F(ImagesTest, BigEndianPfmIsRead) {
    std::ofstream(path("b.pfm"), std::ios::binary) << std::string("Pf\n1 1\n1.0\n\x40\x00\x00\x00", 15);
    EXPECT_THAT(read_disparity_pfm(path("b.pfm")).values, testing::ElementsAre(2.0F));
}

TEST_F(ImagesTest, BadFilesAreRefusedByName) {
    std::ofstream(path("short.pfm"), std::ios::binary) << "Pf\n4 4\n-1.0\nabc";
    std::ofstream(path("text.pfm")) << "<html>";
    write_png(path("colour.png"), cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(3)));
    for (const char* name : {"short.pfm", "text.pfm", "missing.pfm"}) {
        EXPECT_THROW(
            {
                try {
                    read_disparity_pfm(path(name));
                } catch (const std::invalid_argument& error) {
                    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(name), testing::HasSubstr("allowed")));
                    throw;
                }
            },
            std::invalid_argument);
    }
    EXPECT_THROW(read_disparity_png(path("colour.png")), std::invalid_argument);
    EXPECT_THROW(read_disparity_png(path("text.pfm")), std::invalid_argument);
}

TEST_F(ImagesTest, UnwritableFileIsARuntimeError) {
    const Sample sample = random_sample({0, 16}, 4, 4);
    try {
        write_disparity_png(path("no/such/folder.png"), sample.map());
        FAIL() << "was written";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("No such file"));
    }
}

TEST_F(ImagesTest, DepthRoundTrip) {
    const std::vector<std::uint16_t> depth{0, 1, 1000, 65534, 65535, 7};
    write_depth_png(path("z.png"), {depth.data(), 3, 2, 3});
    const cv::Mat stored = read_image(path("z.png"));
    ASSERT_EQ(stored.type(), CV_16UC1);
    EXPECT_EQ(std::vector<std::uint16_t>(stored.begin<std::uint16_t>(), stored.end<std::uint16_t>()), depth);
}

TEST(ColourMapTest, RejectedPixelsAreOfNoColourOfTheMap) {
    for (const cv::Vec3b& colour : colour_map()) {
        EXPECT_GT(cv::norm(colour, rejected_colour), 70) << colour;
    }
}

TEST(PictureTest, FarAndNearHaveTheEndsOfTheMap) {
    const Sample sample{{0, 64}, 3, 1, {-16, 0, 63 * 16}};
    const cv::Mat coloured = colour_disparity(sample.map(), whole_range(sample.range));
    EXPECT_EQ(coloured.at<cv::Vec3b>(0, 0), rejected_colour);
    EXPECT_EQ(coloured.at<cv::Vec3b>(0, 1), colour_map().front());
    EXPECT_EQ(coloured.at<cv::Vec3b>(0, 2), colour_map().back());
}

TEST(PictureTest, DrawnPicturesSaySoWhereThereIsRoom) {
    cv::Mat picture(60, 120, CV_8UC3, cv::Scalar(7, 7, 7));
    mark_synthetic(picture);
    EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0)) << "the ground of the text";
    EXPECT_EQ(picture.at<cv::Vec3b>(59, 119), cv::Vec3b(7, 7, 7)) << "the rest stays";
    double brightest = 0;
    cv::minMaxLoc(picture.reshape(1), nullptr, &brightest);
    EXPECT_GT(brightest, 200) << "the text";
    cv::Mat small(8, 120, CV_8UC3, cv::Scalar(7, 7, 7));
    mark_synthetic(small);
    EXPECT_EQ(small.at<cv::Vec3b>(0, 0), cv::Vec3b(7, 7, 7));
}

TEST(PictureTest, FittedScaleLeavesOutliersOut) {
    Sample sample{{0, 128}, 1000, 1, std::vector<std::int16_t>(1000, 20 * 16)};
    sample.d16[0] = 127 * 16;
    sample.d16[1] = 0;
    std::fill(sample.d16.begin() + 500, sample.d16.end(), std::int16_t{40 * 16 + 3});
    const ColourScale scale = fitted(sample.map());
    EXPECT_EQ(scale.low, 20);
    EXPECT_EQ(scale.high, 41);
    std::fill(sample.d16.begin(), sample.d16.end(), std::int16_t{-16});
    EXPECT_EQ(fitted(sample.map()).high, 127);
}

TEST(PictureTest, LeftDisparityAndScaleStandSideBySide) {
    const Sample sample = random_sample({0, 64}, 320, 240);
    const cv::Mat left(240, 320, CV_8UC1, cv::Scalar(77));
    const ColourScale scale = whole_range(sample.range);
    const cv::Mat plain = picture(left, sample.map(), scale, {});
    const cv::Mat metric = picture(left, sample.map(), scale, {500, 120, 0});
    EXPECT_EQ(plain.rows, 240);
    EXPECT_GT(plain.cols, 640);
    EXPECT_GT(metric.cols, plain.cols) << "a column for metres";
    EXPECT_EQ(metric.at<cv::Vec3b>(100, 100), cv::Vec3b(77, 77, 77));
    EXPECT_EQ(cv::norm(metric(cv::Rect(320, 0, 320, 240)), colour_disparity(sample.map(), scale), cv::NORM_INF), 0);
}

/// The rows or columns at the edges that hold nothing but the background.
int empty_border(const cv::Mat& picture, bool right) {
    const cv::Vec3b paper = picture.at<cv::Vec3b>(0, 0);
    const int lines = right ? picture.cols : picture.rows;
    int empty = 0;
    while (empty < lines) {
        const int at = lines - 1 - empty;
        const cv::Mat line = right ? picture.col(at) : picture.row(at);
        if (cv::norm(line, cv::Mat(line.size(), CV_8UC3, cv::Scalar(paper)), cv::NORM_INF) > 0) {
            break;
        }
        ++empty;
    }
    return empty;
}

TEST(PictureTest, AScaleHasAllItsTextAtAnyHeight) {
    for (const int height : {1, 2, 10, 60, 96, 480, 1242}) {
        for (const ColourScale& scale : {ColourScale{0, 255}, ColourScale{-256, -1}, ColourScale{-3, -2}}) {
            for (const Metric& metric : {Metric{700, 120, 5}, Metric{90'000, 9'000, 300}, Metric{}}) {
                const cv::Mat bar = scale_bar(height, scale, metric);
                EXPECT_GE(bar.rows, height);
                EXPECT_EQ(bar.rows, std::max(height, scale_bar(1, scale, metric).rows));
                EXPECT_GE(empty_border(bar, true), 3) << "text is cut off at the right";
                EXPECT_GE(empty_border(bar, false), 3) << "text is cut off below";
            }
        }
    }
}

TEST(PictureTest, ASmallPictureIsEnlargedForItsScale) {
    const Sample sample = random_sample({0, 64}, 40, 20);
    const ColourScale scale = whole_range(sample.range);
    const cv::Mat all = picture(cv::Mat(20, 40, CV_8UC1, cv::Scalar(77)), sample.map(), scale, {500, 120, 0});
    const cv::Mat bar = scale_bar(20, scale, {500, 120, 0});
    ASSERT_EQ(all.rows, bar.rows);
    ASSERT_EQ(all.cols, 80 + bar.cols);
    EXPECT_EQ(cv::norm(all.colRange(80, all.cols), bar, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(all(cv::Rect(40, 0, 40, 20)), colour_disparity(sample.map(), scale), cv::NORM_INF), 0);
}

TEST(PictureTest, AScaleShowsTheColourOfRejectedPixels) {
    const cv::Mat bar = scale_bar(100, {0, 63}, {});
    cv::Mat swatch;
    cv::inRange(bar.colRange(0, bar.cols / 2), cv::Scalar(rejected_colour), cv::Scalar(rejected_colour), swatch);
    EXPECT_GT(cv::countNonZero(swatch), 50);
}

TEST(PictureTest, OneRuleForTheColours) {
    const Sample sample{{0, 64}, 3, 1, {-16, 10 * 16, 20 * 16}};
    EXPECT_EQ(colour_scale(sample.map(), ColourRange::searched).high, 63);
    EXPECT_EQ(colour_scale(sample.map(), ColourRange::frame).high, 20);
    EXPECT_EQ(colour_scale(sample.map(), ColourRange::frame).low, 10);
}

TEST_F(ImagesTest, TheNameSaysTheFormat) {
    const cv::Mat image(40, 60, CV_8UC3, cv::Scalar(20, 120, 220));
    const std::map<std::string, std::string> first_bytes{
        {"a.png", "\x89PNG"}, {"b.PNG", "\x89PNG"}, {"c.jpg", "\xff\xd8\xff"}, {"d.jpeg", "\xff\xd8\xff"}};
    for (const auto& [name, magic] : first_bytes) {
        write_picture(path(name), image);
        std::ifstream file(path(name), std::ios::binary);
        const std::string bytes(std::istreambuf_iterator<char>(file), {});
        EXPECT_EQ(bytes.substr(0, magic.size()), magic) << name;
        EXPECT_LE(cv::norm(read_image(path(name)), image, cv::NORM_INF), 4) << name;
    }
    for (const char* name : {"e.bmp", "png", "f", "g.png.txt"}) {
        EXPECT_THAT([&] { write_picture(path(name), image); },
                    testing::ThrowsMessage<std::invalid_argument>(
                        testing::AllOf(testing::HasSubstr(name), testing::HasSubstr("allowed: .png, .jpg, .jpeg"))));
        EXPECT_FALSE(std::filesystem::exists(path(name)));
    }
}

TEST(MetricTest, DistanceFollowsFromDisparity) {
    EXPECT_DOUBLE_EQ((Metric{700, 120, 0}.metres(42)), 2.0);
    EXPECT_DOUBLE_EQ((Metric{700, 120, 2}.metres(40)), 2.0);
    EXPECT_EQ((Metric{700, 120, 0}.metres(0)), std::numeric_limits<double>::infinity());
    EXPECT_EQ((Metric{}.metres(10)), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace disparityd::images
