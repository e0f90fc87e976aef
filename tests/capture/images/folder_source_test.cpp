// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <thread>

#include "capture/frame_source.h"
#include "capture/images/image_times.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::numbered_image;
using test::refusal;
using test::soon;
using test::TemporaryFolder;
using test::write_file;
using test::write_image;
using testing::AllOf;
using testing::HasSubstr;
using Next = FrameSource::Next;

SourceOptions offline(const std::string& uri) {
    SourceOptions options;
    options.uri = uri;
    options.pace = Pace::fastest;
    return options;
}

/// The bytes of one eye equal an image.
void expect_eye(const RawFrame& frame, Eye eye, const cv::Mat& image) {
    const Plane<const std::uint8_t> plane = frame.image.eye(eye);
    ASSERT_EQ(plane.width, image.cols * image.channels());
    ASSERT_EQ(plane.height, image.rows);
    for (int y = 0; y < plane.height; ++y) {
        ASSERT_TRUE(std::equal(plane.row(y), plane.row(y) + plane.width, image.ptr<std::uint8_t>(y))) << "row " << y;
    }
}

void make_folders(const TemporaryFolder& folder, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        std::filesystem::create_directories(folder.file(name));
    }
}

TEST(FolderSource, OddWidthGreyPairWithoutCalibrationIsRectifiedAndHasNoScale) {
    const TemporaryFolder folder;
    const cv::Mat left = numbered_image(7, 5, CV_8UC1, 1);
    const cv::Mat right = numbered_image(7, 5, CV_8UC1, 2);
    write_image(folder.file("im2.pgm"), left);
    write_image(folder.file("im6.pgm"), right);
    const auto source = open_source(offline(folder.file("")));
    const SourceInfo& info = source->info();
    EXPECT_EQ(info.eye_width, 7);
    EXPECT_EQ(info.height, 5);
    EXPECT_EQ(info.format, PixelFormat::grey8);
    EXPECT_FALSE(info.live);
    EXPECT_EQ(info.frame_count, 1U);
    ASSERT_TRUE(info.calibration);
    EXPECT_TRUE(info.calibration->rectified);
    EXPECT_EQ(info.calibration->left.fx, 0);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    expect_eye(frame, Eye::left, left);
    expect_eye(frame, Eye::right, right);
    source->give_back(frame);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(FolderSource, ColourPairWithMiddleburyCalibration) {
    const TemporaryFolder folder;
    const cv::Mat left = numbered_image(8, 6, CV_8UC3, 1);
    const cv::Mat right = numbered_image(8, 6, CV_8UC3, 2);
    write_image(folder.file("im0.png"), left);
    write_image(folder.file("im1.png"), right);
    write_file(folder.file("calib.txt"),
               "cam0=[9.5 0 3; 0 9.5 2; 0 0 1]\ncam1=[9.5 0 4.25; 0 9.5 2; 0 0 1]\n"
               "doffs=1.25\nbaseline=193.001\nwidth=8\nheight=6\nndisp=4\n");
    const auto source = open_source(offline(folder.file("")));
    EXPECT_EQ(source->info().format, PixelFormat::bgr24);
    ASSERT_TRUE(source->info().calibration);
    EXPECT_DOUBLE_EQ(source->info().calibration->left.fx, 9.5);
    EXPECT_DOUBLE_EQ(source->info().calibration->right.cx, 4.25);
    EXPECT_DOUBLE_EQ(source->info().calibration->translation[0], -193.001);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    expect_eye(frame, Eye::left, left);
    expect_eye(frame, Eye::right, right);
    source->give_back(frame);
}

TEST(FolderSource, KittiOdometryWithItsTimesAndTheGreyCamerasCalibration) {
    const TemporaryFolder folder;
    make_folders(folder, {"image_0", "image_1"});
    for (int i = 0; i < 3; ++i) {
        const std::string name = "/00000" + std::to_string(i) + ".png";
        write_image(folder.file("image_0" + name), numbered_image(6, 4, CV_8UC1, i));
        write_image(folder.file("image_1" + name), numbered_image(6, 4, CV_8UC1, 10 + i));
    }
    write_file(folder.file("calib.txt"),
               "P0: 7.5 0 3 0 0 7.5 2 0 0 0 1 0\nP1: 7.5 0 3 -4.05 0 7.5 2 0 0 0 1 0\n"
               "P2: 8 0 3 0.5 0 8 2 0 0 0 1 0\nP3: 8 0 3 -3.5 0 8 2 0 0 0 1 0\n");
    write_file(folder.file("times.txt"), "0.000000e+00\n1.036224e-01\r\n2.072e-01\n");
    const auto source = open_source(offline(folder.file("")));
    ASSERT_TRUE(source->info().calibration);
    EXPECT_DOUBLE_EQ(source->info().calibration->left.fx, 7.5);
    EXPECT_NEAR(source->info().calibration->translation[0], -540, 1e-9);
    const std::int64_t expected[] = {0, 103'622'400, 207'200'000};
    for (int i = 0; i < 3; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
        EXPECT_EQ(frame.monotonic_ns, expected[i]);
        expect_eye(frame, Eye::right, numbered_image(6, 4, CV_8UC1, 10 + i));
        source->give_back(frame);
    }
    RawFrame frame;
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(FolderSource, ANamedKittiCalibrationGivesThePairThatTheImagesAreOf) {
    const TemporaryFolder folder;
    make_folders(folder, {"image_0", "image_1"});
    write_file(folder.file("both.txt"),
               "P0: 7.5 0 3 0 0 7.5 2 0 0 0 1 0\nP1: 7.5 0 3 -4.05 0 7.5 2 0 0 0 1 0\n"
               "P2: 8 0 3 0.5 0 8 2 0 0 0 1 0\nP3: 8 0 3 -3.5 0 8 2 0 0 0 1 0\n");
    const auto focal_length = [&](const std::string& left, const std::string& right, int type) {
        write_image(folder.file(left), numbered_image(6, 4, type, 1));
        write_image(folder.file(right), numbered_image(6, 4, type, 2));
        SourceOptions options = offline(folder.file(left) + "," + folder.file(right));
        options.calibration_path = folder.file("both.txt");
        return open_source(options)->info().calibration->left.fx;
    };
    EXPECT_EQ(focal_length("image_0/0.png", "image_1/0.png", CV_8UC1), 7.5);
    EXPECT_EQ(focal_length("image_0/1.png", "image_1/1.png", CV_8UC3), 7.5) << "the folder counts first";
    EXPECT_EQ(focal_length("l.png", "r.png", CV_8UC1), 7.5);
    EXPECT_EQ(focal_length("left.png", "right.png", CV_8UC3), 8);
}

TEST(FolderSource, KittiRawFolders) {
    const TemporaryFolder folder;
    make_folders(folder, {"drive/image_02/data", "drive/image_03/data"});
    write_image(folder.file("drive/image_02/data/0000000000.png"), numbered_image(6, 4, CV_8UC3, 1));
    write_image(folder.file("drive/image_03/data/0000000000.png"), numbered_image(6, 4, CV_8UC3, 2));
    write_file(folder.file("drive/image_02/timestamps.txt"), "2011-09-26 13:02:25.964389445\n");
    write_file(folder.file("calib_cam_to_cam.txt"),
               "calib_time: 09-Jan-2012 13:57:47\n"
               "P_rect_00: 7 0 3 0 0 7 2 0 0 0 1 0\n"
               "P_rect_02: 8 0 3 0.4 0 8 2 0 0 0 1 0\n"
               "P_rect_03: 8 0 3 -3.6 0 8 2 0 0 0 1 0\n");
    const auto source = open_source(offline(folder.file("drive")));
    ASSERT_TRUE(source->info().calibration);
    EXPECT_NEAR(source->info().calibration->translation[0], -500, 1e-9);
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    EXPECT_EQ(frame.realtime_ns, 1'317'042'145'964'389'445);
    source->give_back(frame);
}

TEST(FolderSource, PatternsOfPairsAndOfSideBySideImages) {
    const TemporaryFolder folder;
    for (const int i : {8, 9, 10}) {
        char number[8];
        std::snprintf(number, sizeof number, "%02d", i);
        write_image(folder.file(std::string("l_") + number + ".png"), numbered_image(5, 3, CV_8UC1, i));
        write_image(folder.file(std::string("r_") + number + ".png"), numbered_image(5, 3, CV_8UC1, 50 + i));
        write_image(folder.file("both" + std::to_string(i) + ".png"), numbered_image(10, 3, CV_8UC1, 90 + i));
    }
    const auto pairs = open_source(offline(folder.file("l_%02d.png") + "," + folder.file("r_%02d.png")));
    const auto both = open_source(offline(folder.file("both%d.png")));
    EXPECT_FALSE(pairs->info().calibration) << "nothing says that they are rectified";
    EXPECT_EQ(both->info().eye_width, 5);
    for (const int i : {8, 9, 10}) {
        RawFrame frame;
        ASSERT_EQ(pairs->next(frame, soon()), Next::frame);
        expect_eye(frame, Eye::left, numbered_image(5, 3, CV_8UC1, i));
        expect_eye(frame, Eye::right, numbered_image(5, 3, CV_8UC1, 50 + i));
        pairs->give_back(frame);
        ASSERT_EQ(both->next(frame, soon()), Next::frame);
        const cv::Mat image = numbered_image(10, 3, CV_8UC1, 90 + i);
        expect_eye(frame, Eye::left, image.colRange(0, 5));
        expect_eye(frame, Eye::right, image.colRange(5, 10));
        both->give_back(frame);
    }
}

TEST(FolderSource, LoopCountsOnAndFlagsTheJump) {
    const TemporaryFolder folder;
    write_image(folder.file("left.png"), numbered_image(5, 3, CV_8UC1, 1));
    write_image(folder.file("right.png"), numbered_image(5, 3, CV_8UC1, 2));
    SourceOptions options = offline(folder.file(""));
    options.loop = true;
    const auto source = open_source(options);
    EXPECT_FALSE(source->info().frame_count);
    for (std::uint64_t i = 0; i < 3; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, i);
        EXPECT_EQ(frame.monotonic_ns, static_cast<std::int64_t>(i) * 100'000'000);
        EXPECT_EQ(frame.flags, i == 0 ? frame_flag_none : frame_flag_discontinuity);
        source->give_back(frame);
    }
}

TEST(FolderSource, LoansAreBoundedAndInterruptEndsTheWait) {
    const TemporaryFolder folder;
    write_image(folder.file("left.png"), numbered_image(5, 3, CV_8UC1, 1));
    write_image(folder.file("right.png"), numbered_image(5, 3, CV_8UC1, 2));
    SourceOptions options = offline(folder.file(""));
    options.loop = true;
    options.loans = 2;
    const auto source = open_source(options);
    RawFrame first, second, third;
    ASSERT_EQ(source->next(first, soon()), Next::frame);
    ASSERT_EQ(source->next(second, soon()), Next::frame);
    EXPECT_NE(first.image.data, second.image.data);
    EXPECT_EQ(source->next(third, std::chrono::steady_clock::now()), Next::timeout);
    source->give_back(first);
    ASSERT_EQ(source->next(third, soon()), Next::frame);
    EXPECT_EQ(third.image.data, first.image.data);
    std::thread other([&] { source->interrupt(); });
    EXPECT_EQ(source->next(first, soon()), Next::interrupted);
    other.join();
    EXPECT_EQ(source->next(first, soon()), Next::interrupted);
}

TEST(FolderSource, AnotherThreadGivesBackWhatTheWaitNeeds) {
    const TemporaryFolder folder;
    write_image(folder.file("left.png"), numbered_image(5, 3, CV_8UC1, 1));
    write_image(folder.file("right.png"), numbered_image(5, 3, CV_8UC1, 2));
    SourceOptions options = offline(folder.file(""));
    options.loop = true;
    options.loans = 1;
    const auto source = open_source(options);
    for (int i = 0; i < 50; ++i) {
        RawFrame frame;
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        std::thread([&] { source->give_back(frame); }).join();
    }
}

TEST(FolderSource, SourcePaceKeepsTheRate) {
    const TemporaryFolder folder;
    for (int i = 0; i < 3; ++i) {
        write_image(folder.file(std::to_string(i) + ".png"), numbered_image(6, 3, CV_8UC1, i));
    }
    SourceOptions options = offline(folder.file("%d.png"));
    options.pace = Pace::source;
    const auto source = open_source(options);
    RawFrame frame;
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        source->give_back(frame);
    }
    EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(200));
}

TEST(FolderSourceRefuses, UnequalSizesWithinAPairAndBetweenFrames) {
    const TemporaryFolder folder;
    write_image(folder.file("left.png"), numbered_image(5, 3, CV_8UC1, 1));
    write_image(folder.file("right.png"), numbered_image(6, 3, CV_8UC1, 2));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file(""))); }),
                AllOf(HasSubstr("left.png is 5x3"), HasSubstr("right.png is 6x3")));
    write_image(folder.file("a0.ppm"), numbered_image(6, 3, CV_8UC3, 1));
    write_image(folder.file("a1.ppm"), numbered_image(6, 5, CV_8UC3, 1));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("a%d.ppm"))); }),
                AllOf(HasSubstr("a0.ppm is 6x3"), HasSubstr("a1.ppm is 6x5")));
}

TEST(FolderSourceRefuses, UnequalSizesThatOnlyDecodingShowsEndTheSource) {
    const TemporaryFolder folder;
    write_image(folder.file("a0.bmp"), numbered_image(6, 3, CV_8UC3, 1));
    write_image(folder.file("a1.bmp"), numbered_image(6, 3, CV_8UC3, 1));
    const auto source = open_source(offline(folder.file("a%d.bmp")));
    write_image(folder.file("a1.bmp"), numbered_image(6, 5, CV_8UC3, 1));  // after the headers were looked at
    RawFrame frame;
    ASSERT_EQ(source->next(frame, soon()), Next::frame);
    source->give_back(frame);
    try {
        source->next(frame, soon());
        FAIL() << "the second image was taken";
    } catch (const std::runtime_error& problem) {
        EXPECT_THAT(problem.what(), HasSubstr("a1.bmp is 6x5"));
    }
    EXPECT_EQ(source->next(frame, soon()), Next::end);
}

TEST(FolderSourceRefuses, WhatIsNoUsableImage) {
    const TemporaryFolder folder;
    write_image(folder.file("deep0.tif"), cv::Mat(3, 4, CV_32FC1, cv::Scalar(0.5)));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("deep%d.tif"))); }),
                AllOf(HasSubstr("deep0.tif"), HasSubstr("found pixels of 32 bits"), HasSubstr("8 and 16 bits")));
    write_file(folder.file("text0.png"), "not an image");
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("text%d.png"))); }), HasSubstr("text0.png"));
    write_image(folder.file("odd0.png"), numbered_image(5, 3, CV_8UC1, 1));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("odd%d.png"))); }),
                AllOf(HasSubstr("even width"), HasSubstr("found 5")));
}

TEST(FolderSourceRefuses, MissingFilesAndFolders) {
    const TemporaryFolder folder;
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file(""))); }), HasSubstr("left_%04d.png"));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("nothing%d.png"))); }), HasSubstr("nothing0.png"));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("absent"))); }), HasSubstr("no such file or folder"));
    EXPECT_THAT(refusal([&] { open_source(offline("zed2:0")); }),
                AllOf(HasSubstr("zed2:0"), HasSubstr("scene:vga@15")));
    write_image(folder.file("l1.png"), numbered_image(4, 3, CV_8UC1, 1));
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file("l%d.png") + "," + folder.file("r%d.png"))); }),
                HasSubstr("r1.png"));
    SourceOptions none = offline(folder.file("l%d.png"));
    none.loans = 0;
    EXPECT_THAT(refusal([&] { open_source(none); }), HasSubstr("at least 1"));
}

TEST(FolderSourceRefuses, ACalibrationOfAnotherSize) {
    const TemporaryFolder folder;
    write_image(folder.file("im0.png"), numbered_image(8, 6, CV_8UC1, 1));
    write_image(folder.file("im1.png"), numbered_image(8, 6, CV_8UC1, 2));
    write_file(folder.file("calib.txt"),
               "cam0=[9.5 0 3; 0 9.5 2; 0 0 1]\ncam1=[9.5 0 4.25; 0 9.5 2; 0 0 1]\n"
               "doffs=1.25\nbaseline=193.001\nwidth=16\nheight=12\n");
    EXPECT_THAT(refusal([&] { open_source(offline(folder.file(""))); }),
                AllOf(HasSubstr("calib.txt"), HasSubstr("16"), HasSubstr("8")));
}

TEST(FolderSourceRefuses, KittiCamerasThatCannotBe) {
    const TemporaryFolder folder;
    make_folders(folder, {"image_0", "image_1"});
    for (const char* name : {"image_0/000000.png", "image_1/000000.png"}) {
        write_image(folder.file(name), numbered_image(6, 4, CV_8UC1, 1));
    }
    const std::string left = "P0: 7.5 0 3 0 0 7.5 2 0 0 0 1 0\nP1: ";
    for (const auto& [right, said] : {std::pair("7.5 0 3 4.05 0 7.5 2 0 0 0 1 0", "exchange the two"),
                                      {"1e300 0 3 -4.05 0 7.5 2 0 0 0 1 0", "P1: found focal lengths"},
                                      {"7.5 0 134217700 -4.05 0 7.5 2 0 0 0 1 0", "principal point"}}) {
        write_file(folder.file("calib.txt"), left + right + "\n");
        EXPECT_THAT(refusal([&] { open_source(offline(folder.file(""))); }),
                    AllOf(HasSubstr("calib.txt"), HasSubstr(said)));
    }
}

TEST(ImageTimes, RefusesWhatIsNoTime) {
    const TemporaryFolder folder;
    const std::string path = folder.file("times.txt");
    write_file(path, "0\n0.1\n");
    EXPECT_EQ(read_image_times(path, 2), (std::vector<std::int64_t>{0, 100'000'000}));
    EXPECT_THAT(refusal([&] { read_image_times(path, 3); }), HasSubstr("found 2 times for 3 frames"));
    for (const char* text : {"0\n0,1\n", "1\n0\n", "0\nnan\n", "0\n2011-13-26 13:02:25\n", "0\n-1\n", "0\n1e300\n"}) {
        write_file(path, text);
        EXPECT_THAT(refusal([&] { read_image_times(path, 2); }), HasSubstr("time 2")) << text;
    }
}

}  // namespace
}  // namespace disparityd::capture
