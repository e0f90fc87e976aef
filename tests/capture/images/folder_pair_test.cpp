// SPDX-License-Identifier: Apache-2.0
//
// A folder for each eye, names that are times, and names with commas and blanks.
#include "capture/images/folder_pair.h"

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "capture/images/image_sequence.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::numbered_image;
using test::refusal;
using test::soon;
using test::TemporaryFolder;
using test::write_image;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using Next = FrameSource::Next;

/// What a source gave, a line for each frame: "name time left-pixel right-pixel".
std::vector<std::string> played(const std::string& uri, std::vector<std::string>* notices = nullptr) {
    SourceOptions options;
    options.uri = uri;
    options.pace = Pace::fastest;
    options.report = [notices](const std::string& line, bool) {
        if (notices != nullptr) {
            notices->push_back(line);
        }
    };
    const auto source = open_source(options);
    std::vector<std::string> lines;
    RawFrame frame;
    while (source->next(frame, soon()) == Next::frame) {
        const std::uint8_t* row = frame.image.data;
        lines.push_back(std::string(frame.name) + " " + std::to_string(frame.monotonic_ns / 1'000'000) + " " +
                        std::to_string(row[0]) + " " + std::to_string(row[frame.image.eye_width]));
        source->give_back(frame);
    }
    return lines;
}

/// Images whose first pixel is 31 times the number.
void make_images(const std::string& folder, const std::vector<std::string>& names, int first) {
    std::filesystem::create_directories(folder);
    for (const std::string& name : names) {
        write_image((std::filesystem::path(folder) / name).string(), numbered_image(6, 4, CV_8UC1, first++));
    }
}

TEST(FolderPair, TheNamesOfItsFoldersAreKnown) {
    for (const auto& [left, right] : {std::pair("left", "right"), std::pair("Left", "Right"),
                                      std::pair("mav0/cam0/data", "mav0/cam1/data"), std::pair("cam0", "cam1")}) {
        SCOPED_TRACE(left);
        const TemporaryFolder folder;
        make_images(folder.file(left), {"1.png", "2.png", "10.png"}, 0);
        make_images(folder.file(right), {"1.png", "2.png", "10.png"}, 4);
        EXPECT_THAT(played(folder.file("")), ElementsAre("1.png 0 0 124", "2.png 100 31 155", "10.png 200 62 186"));
    }
    for (const auto& [left, right] : {std::pair("Left.png", "Right.png"),
                                      {"LEFT.PNG", "RIGHT.PNG"},
                                      {"im0.PNG", "IM1.png"},
                                      {"imL.bmp", "imR.bmp"}}) {
        const TemporaryFolder files;
        make_images(files.file(""), {left, right}, 0);
        EXPECT_THAT(played(files.file("")), ElementsAre(std::string(left) + " 0 0 31"));
    }
}

TEST(FolderPair, NumbersMayStandAnywhereInTheNames) {
    for (const auto& [left, right] : {std::pair("_left", "_right"), {"-L", "-R"}, {".cam-a", ".cam-b"}}) {
        SCOPED_TRACE(left);
        const TemporaryFolder folder;
        for (const std::string number : {"9", "010", "11"}) {
            make_images(folder.file("left"), {"frame_" + number + left + ".png"}, 0);
            make_images(folder.file("right"), {"frame_" + number + right + ".png"}, 4);
        }
        const std::string end = std::string(left) + ".png";
        EXPECT_THAT(played(folder.file("")), ElementsAre("frame_9" + end + " 0 0 124", "frame_010" + end + " 100 0 124",
                                                         "frame_11" + end + " 200 0 124"));
    }
}

TEST(FolderPair, HiddenFilesAreNoImages) {
    const TemporaryFolder folder;
    for (const char* eye : {"left", "right"}) {
        make_images(folder.file(eye), {"1.png"}, 0);
        test::write_file(folder.file(std::string(eye) + "/._1.png"), "of another system");
    }
    EXPECT_THAT(played(folder.file("")), ElementsAre("1.png 0 0 0"));
}

TEST(FolderPair, TwoFoldersAreAPair) {
    const TemporaryFolder folder;
    make_images(folder.file("my, left"), {"l_0009.png", "l_0010.png"}, 0);
    make_images(folder.file("my right"), {"r_0008.png", "r_0009.png", "r_0010.png"}, 3);
    EXPECT_THAT(played(folder.file("my, left") + "," + folder.file("my right")),
                ElementsAre("l_0009.png 0 0 124", "l_0010.png 100 31 155"));
    std::vector<std::string> notices;
    played(folder.file("my, left") + "," + folder.file("my right"), &notices);
    EXPECT_THAT(notices, ElementsAre(HasSubstr("my right: holds 3 images for 2 left images")));
    EXPECT_THAT(refusal([&] { played(folder.file("my right") + "," + folder.file("my right/")); }),
                HasSubstr("my right: is named for both eyes"));
    make_images(folder.file("my right"), {"x_0010.png"}, 3);
    EXPECT_THAT(refusal([&] { played(folder.file("my, left") + "," + folder.file("my right")); }),
                HasSubstr("several images of one number, r_0010.png and x_0010.png"));
    std::filesystem::remove(folder.file("my right/x_0010.png"));
    std::filesystem::remove(folder.file("my right/r_0010.png"));
    EXPECT_THAT(refusal([&] { played(folder.file("my, left") + "," + folder.file("my right")); }),
                AllOf(HasSubstr("l_0010.png: has no right image"), HasSubstr("of the same number")));
}

TEST(FolderPair, NamesThatAreTimesAreTheTimes) {
    const TemporaryFolder folder;
    const std::vector<std::string> ns{"1712345678700000512.png", "1712345678733333504.png", "1712345678800000256.png"};
    make_images(folder.file("mav0/cam0/data"), ns, 0);
    make_images(folder.file("mav0/cam1/data"), ns, 3);
    const auto expected = ElementsAre(ns[0] + " 0 0 93", ns[1] + " 33 31 124", ns[2] + " 99 62 155");
    EXPECT_THAT(played(folder.file("mav0")), expected);
    EXPECT_THAT(played(folder.file("")), expected) << "the folder above";
    EXPECT_THAT(played(folder.file("mav0/cam0") + "," + folder.file("mav0/cam1")), expected) << "those below";
    EXPECT_THAT(played(folder.file("mav0/cam0/data/%d.png") + "," + folder.file("mav0/cam1/data/%d.png")), expected);

    const std::vector<std::string> seconds{"99.5.png", "100.25.png", "100.250000001.png"};
    make_images(folder.file("tum/left"), seconds, 0);
    make_images(folder.file("tum/right"), seconds, 3);
    EXPECT_THAT(played(folder.file("tum")),
                ElementsAre("99.5.png 0 0 93", "100.25.png 750 31 124", "100.250000001.png 750 62 155"));
}

TEST(FolderPair, TimesMayStandBesideWords) {
    const std::vector<std::string> numbers[] = {{"1712345678700000512", "1712345678750000512"},
                                                {"1712345678.70", "1712345678.750000"},
                                                {"1712345678700000", "1712345678750000"}};
    for (const auto& stamps : numbers) {
        const TemporaryFolder folder;
        make_images(folder.file("left"), {"cam0_" + stamps[0] + "_l.png", "cam0_" + stamps[1] + "_l.png"}, 0);
        make_images(folder.file("right"), {"cam1_" + stamps[0] + "_r.png", "cam1_" + stamps[1] + "_r.png"}, 3);
        EXPECT_THAT(played(folder.file("")),
                    ElementsAre("cam0_" + stamps[0] + "_l.png 0 0 93", "cam0_" + stamps[1] + "_l.png 50 31 124"));
    }
    for (const auto& counters : {std::pair("v1.0", "v1.5"), {"a_0000000000001", "a_0000000000002"}, {"b1", "b2"}}) {
        const TemporaryFolder folder;
        const std::vector<std::string> names{std::string(counters.first) + ".png",
                                             std::string(counters.second) + ".png"};
        make_images(folder.file("left"), names, 0);
        make_images(folder.file("right"), names, 3);
        EXPECT_THAT(played(folder.file("")), ElementsAre(names[0] + " 0 0 93", names[1] + " 100 31 124")) << "counted";
    }
}

TEST(FolderPair, TimesOfNames) {
    EXPECT_EQ(time_of_name("1403636579763555584"), 1403636579763555584);
    EXPECT_EQ(time_of_name("1403636579763555"), 1403636579763555000);
    EXPECT_EQ(time_of_name("1403636579763"), 1403636579763000000);
    EXPECT_EQ(time_of_name("1403636579.7635"), 1403636579763500000);
    EXPECT_EQ(time_of_name("0.05"), 50'000'000);
    for (const char* name :
         {"", "000012", "left_0001", "1.2.3", ".5", "5.", "9403636579763555584", "14036365797635555840"}) {
        EXPECT_FALSE(time_of_name(name)) << name;
    }
}

TEST(FolderPair, PatternsInFoldersWithCommasAreFound) {
    const TemporaryFolder folder;
    make_images(folder.file("a, b"), {"l1.png", "r1.png"}, 0);
    EXPECT_THAT(played(folder.file("a, b/l%d.png") + "," + folder.file("a, b/r%d.png")), ElementsAre("l1.png 0 0 31"));
    write_image(folder.file("a, b/both1.png"), numbered_image(8, 4, CV_8UC1, 0));
    std::vector<std::string> notices;
    EXPECT_THAT(played(folder.file("a, b/both%d.png"), &notices), ElementsAre("both1.png 0 0 12"));
    EXPECT_THAT(notices, ElementsAre(HasSubstr("each image is taken as both eyes side by side, 4x4 each")));
    // The image of one eye, and eyes above each other, are not cut in two.
    for (const cv::Size& size : {cv::Size(8, 5), cv::Size(8, 16)}) {
        write_image(folder.file("a, b/mono1.png"), numbered_image(size.width, size.height, CV_8UC1, 0));
        EXPECT_THAT(
            refusal([&] { played(folder.file("a, b/mono%d.png")); }),
            HasSubstr("mono1.png: found a picture of 8x" + std::to_string(size.height) + ", which is that of one eye"));
    }
}

TEST(FolderPair, ImagesOfOneSizeCanBePlayedAlone) {
    const TemporaryFolder folder;
    for (const auto& [name, width] : std::map<std::string, int>{{"0", 8}, {"1", 10}, {"2", 10}, {"3", 8}}) {
        for (const char* eye : {"image_2", "image_3"}) {
            std::filesystem::create_directories(folder.file(eye));
            write_image(folder.file(std::string(eye) + "/00000" + name + ".png"), numbered_image(width, 4, CV_8UC1, 0));
        }
    }
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    for (const RunOfOneGeometry& run : runs_of_one_geometry(folder.file(""), true)) {
        runs.emplace_back(run.first, run.count);
    }
    EXPECT_EQ(runs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 1}, {1, 2}, {3, 1}}));
    SourceOptions options;
    options.uri = folder.file("");
    options.pace = Pace::fastest;
    options.first_image = 1;
    options.image_count = 2;
    const auto source = open_source(options);
    EXPECT_EQ(source->info().eye_width, 10);
    EXPECT_EQ(source->info().frame_count, 2U);
    RawFrame frame;
    for (const std::uint64_t sequence : {1U, 2U}) {
        ASSERT_EQ(source->next(frame, soon()), Next::frame);
        EXPECT_EQ(frame.sequence, sequence);
        EXPECT_EQ(frame.monotonic_ns, static_cast<std::int64_t>(sequence) * 100'000'000);
        EXPECT_EQ(frame.flags, frame_flag_none);
        source->give_back(frame);
    }
    EXPECT_EQ(source->next(frame, soon()), Next::end);
    options.first_image = 4;
    EXPECT_THAT(refusal([&] { open_source(options); }), HasSubstr("found 4 frames"));
}

// KITTI's scenes differ in size; so do their calibrations.
TEST(FolderPair, WhatIsLeftOutForItsSizeEndsNothingByItsCalibration) {
    const TemporaryFolder folder;
    const auto calibration = [](int width) {
        return "S_rect_02: " + std::to_string(width) +
               " 4\nP_rect_02: 12.5 0 3.5 1.0 0 12.5 2 0.5 0 0 1 0.003\n"
               "P_rect_03: 12.5 0 3.5 -5.75 0 12.5 2 0.5 0 0 1 0.003\n";
    };
    for (const int i : {0, 1, 2}) {
        const int width = i == 1 ? 10 : 8;
        const std::string name = "00000" + std::to_string(i);
        for (const char* eye : {"image_2", "image_3"}) {
            std::filesystem::create_directories(folder.file(eye));
            write_image(folder.file(eye + ("/" + name) + "_10.png"), numbered_image(width, 4, CV_8UC1, i));
        }
        std::filesystem::create_directories(folder.file("calib_cam_to_cam"));
        test::write_file(folder.file("calib_cam_to_cam/" + name + ".txt"), calibration(width));
    }
    SourceOptions options;
    options.uri = folder.file("");
    options.pace = Pace::fastest;
    EXPECT_THAT(refusal([&] { open_source(options); }), HasSubstr("unequal sizes"));
    options.skip_damaged = true;
    const auto source = open_source(options);
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->left.fx, 12.5);
    std::vector<std::string> names;
    RawFrame frame;
    while (source->next(frame, soon()) == Next::frame) {
        names.emplace_back(frame.name);
        source->give_back(frame);
    }
    EXPECT_THAT(names, ElementsAre("000000_10.png", "000002_10.png"));
}

TEST(UnknownSources, AreToldShortly) {
    const auto said = [](const std::string& uri) {
        return refusal([&] {
            SourceOptions options;
            options.uri = uri;
            open_source(options);
        });
    };
    for (const char* name : {"wlak", "folder/wlak.zip", "/no/such/folder", "a.png"}) {
        const std::string text = said(name);
        EXPECT_THAT(text, HasSubstr("no such file"));
        EXPECT_LT(text.size(), 150U) << text;
    }
    EXPECT_THAT(said("left_*.png"), HasSubstr("left_%d.png"));
    EXPECT_THAT(said("zed:0"), HasSubstr("v4l2:auto"));
}

}  // namespace
}  // namespace disparityd::capture
