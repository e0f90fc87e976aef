// SPDX-License-Identifier: Apache-2.0
//
// Pipelines that are not live: pixels, pairs, times, losses, ends.
#include <cstring>
#include <numeric>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/capture/gstreamer/gst_fixture.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using disparityd::test::TemporaryFolder;
using test::has_element;
using test::height;
using test::numbered_image;
using test::options_of;
using test::play_all;
using test::Played;
using test::test_source;
using test::width;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int pixels = 2 * width * height;

struct Format {
    const char* name;
    int bytes;  ///< of a frame
    PixelFormat format;
    /// Where byte `i` of a row-packed frame of ours lies in the frame of the file.
    std::size_t (*from)(std::size_t i);
};

void PrintTo(const Format& format, std::ostream* stream) {
    *stream << format.name;
}

std::size_t same(std::size_t i) {
    return i;
}
std::size_t rgb(std::size_t i) {
    return i - i % 3 + (2 - i % 3);
}
std::size_t bgrx(std::size_t i) {
    return i / 3 * 4 + i % 3;
}
std::size_t rgbx(std::size_t i) {
    return i / 3 * 4 + (2 - i % 3);
}
std::size_t uyvy(std::size_t i) {
    return i ^ 1U;
}
std::size_t y42b(std::size_t i) {
    return i % 2 == 0 ? i / 2 : pixels + i / 4 + (i % 4 == 3 ? pixels / 2 : 0);
}

class GstFormat : public testing::TestWithParam<Format> {};

TEST_P(GstFormat, IsConvertedByteForByte) {
    const Format& format = GetParam();
    const TemporaryFolder folder;
    std::string file(2 * static_cast<std::size_t>(format.bytes), '\0');
    for (std::size_t i = 0; i < file.size(); ++i) {
        file[i] = static_cast<char>(i * 7 + i / 251);
    }
    const std::string path = folder.write("raw", file);
    const Played played = play_all(options_of(
        "filesrc location=" + path + " ! rawvideoparse format=" + format.name + " width=" + std::to_string(2 * width) +
        " height=" + std::to_string(height) + " framerate=25/1 ! appsink name=stereo"));
    ASSERT_THAT(played.problem, IsEmpty());
    EXPECT_EQ(played.info.format, format.format);
    EXPECT_EQ(played.info.eye_width, width);
    EXPECT_FALSE(played.info.live);
    ASSERT_THAT(played.frames, SizeIs(2));
    for (std::size_t n = 0; n < 2; ++n) {
        const std::vector<std::uint8_t>& got = played.frames[n];
        ASSERT_THAT(got, SizeIs(pixels * bytes_per_pixel(format.format)));
        for (std::size_t i = 0; i < got.size(); ++i) {
            ASSERT_EQ(got[i],
                      static_cast<std::uint8_t>(file[n * static_cast<std::size_t>(format.bytes) + format.from(i)]))
                << "frame " << n << ", byte " << i;
        }
    }
    EXPECT_THAT(played.times, ElementsAre(0, 40'000'000));
}

INSTANTIATE_TEST_SUITE_P(Raw, GstFormat,
                         testing::Values(Format{"gray8", pixels, PixelFormat::grey8, same},
                                         Format{"i420", pixels * 3 / 2, PixelFormat::grey8, same},
                                         Format{"nv12", pixels * 3 / 2, PixelFormat::grey8, same},
                                         Format{"yuy2", pixels * 2, PixelFormat::yuyv, same},
                                         Format{"uyvy", pixels * 2, PixelFormat::yuyv, uyvy},
                                         Format{"y42b", pixels * 2, PixelFormat::yuyv, y42b},
                                         Format{"bgr", pixels * 3, PixelFormat::bgr24, same},
                                         Format{"rgb", pixels * 3, PixelFormat::bgr24, rgb},
                                         Format{"bgrx", pixels * 4, PixelFormat::bgr24, bgrx},
                                         Format{"rgba", pixels * 4, PixelFormat::bgr24, rgbx}),
                         [](const auto& info) { return std::string(info.param.name); });

/// Writes six pairs of images, left_0.png and so on.
void write_images(const TemporaryFolder& folder, int type) {
    for (int i = 0; i < 6; ++i) {
        test::write_image(folder.file("left_" + std::to_string(i) + ".png"), numbered_image(width, height, type, i));
        test::write_image(folder.file("right_" + std::to_string(i) + ".png"),
                          numbered_image(width, height, type, 50 + i));
    }
}

std::string png_eye(const TemporaryFolder& folder, const std::string& eye) {
    return "multifilesrc location=" + folder.file(eye + "_%d.png") +
           " caps=image/png,framerate=20/1 ! pngdec ! appsink name=" + eye + " ";
}

class GstImages : public testing::TestWithParam<int> {};

TEST_P(GstImages, GiveTheBytesOfTheSameFolder) {
    if (!has_element("pngdec")) {
        GTEST_SKIP() << "no pngdec: apt-get install gstreamer1.0-plugins-good";
    }
    const TemporaryFolder folder;
    write_images(folder, GetParam());
    SourceOptions of_folder;
    of_folder.uri = folder.file("left_%d.png") + "," + folder.file("right_%d.png");
    const Played expected = play_all(of_folder);
    const Played played = play_all(options_of(png_eye(folder, "left") + png_eye(folder, "right")));
    EXPECT_THAT(played.problem, IsEmpty());
    EXPECT_EQ(played.info.format, expected.info.format);
    ASSERT_THAT(expected.frames, SizeIs(6));
    EXPECT_TRUE(played.frames == expected.frames);
    EXPECT_EQ(played.info.rate, 20);
    EXPECT_THAT(played.times, ElementsAre(0, 50'000'000, 100'000'000, 150'000'000, 200'000'000, 250'000'000));
    EXPECT_THAT(played.lost, Each(0U));
    EXPECT_TRUE(play_all(options_of(png_eye(folder, "right") + png_eye(folder, "left"))).frames == expected.frames);
}

INSTANTIATE_TEST_SUITE_P(Png, GstImages, testing::Values(CV_8UC1, CV_8UC3),
                         [](const auto& info) { return info.param == CV_8UC1 ? "grey" : "colour"; });

TEST(GstReplay, EyesOfUnequalRatesArePairedByStampAndTheRestIsCounted) {
    const auto play = [] {
        return play_all(options_of(test_source("pattern=ball num-buffers=30", "30", width) + "! appsink name=left " +
                                   test_source("pattern=ball num-buffers=10", "10", width) + "! appsink name=right"));
    };
    const Played played = play();
    EXPECT_THAT(played.problem, IsEmpty());
    ASSERT_THAT(played.frames, SizeIs(10));
    EXPECT_EQ(played.lost[0], 0U);
    EXPECT_EQ(std::accumulate(played.lost.begin(), played.lost.end(), 0U), 18U);
    EXPECT_EQ(played.sequences.back(), 27U);
    EXPECT_EQ(played.times.back(), 900'000'000);
    const Played again = play();
    EXPECT_TRUE(again.frames == played.frames);
    EXPECT_EQ(again.sequences, played.sequences);
}

TEST(GstReplay, FramesThatTheSourceHasNumberedAndLostAreCounted) {
    const Played played = play_all(
        options_of(test_source("num-buffers=60", "10") + "! identity drop-probability=0.4 ! appsink name=stereo"));
    EXPECT_THAT(played.problem, IsEmpty());
    ASSERT_GT(played.frames.size(), 1U);
    ASSERT_LT(played.frames.size(), 60U);
    for (std::size_t i = 0; i < played.frames.size(); ++i) {
        EXPECT_EQ(played.sequences[i] * 100'000'000, static_cast<std::uint64_t>(played.times[i])) << i;
    }
}

TEST(GstReplay, OnePairAfterTheOtherEyeHasEnded) {
    const Played played = play_all(options_of(test_source("num-buffers=100", "10", width) + "! appsink name=left " +
                                              test_source("num-buffers=1", "10", width) + "! appsink name=right"));
    EXPECT_THAT(played.problem, IsEmpty());
    EXPECT_THAT(played.frames, SizeIs(1));
}

TEST(GstReplay, WhatFailsLaterIsTheElementsOwnLineBehindWhatIsWhole) {
    const Played played =
        play_all(options_of(test_source("num-buffers=9", "10") + "! identity name=wire error-after=4 ! appsink"));
    EXPECT_THAT(played.problem, HasSubstr("source gst: wire: Failed after iterations as requested"));
    EXPECT_THAT(played.frames, SizeIs(3));
}

TEST(GstReplay, AnotherSizeInTheMiddleEndsItWithALine) {
    const Played played = play_all(options_of("concat name=c ! appsink " + test_source("num-buffers=2", "10") +
                                              "! c. " + test_source("num-buffers=2", "10", 4 * width) + "! c."));
    EXPECT_THAT(played.problem, HasSubstr("the pictures change from 128x48 to 256x48"));
    EXPECT_THAT(played.frames, SizeIs(2));
}

TEST(GstReplay, AnotherSizeOfOneOfTwoEyesEndsItBehindThePairs) {
    const auto changes = [](const std::string& name, const std::string& eye, int later) {
        return "concat name=" + name + " ! appsink name=" + eye + " " + test_source("num-buffers=2", "10", width) +
               "! " + name + ". " + test_source("num-buffers=2", "10", later) + "! " + name + ". ";
    };
    for (const auto& [left, right] : {std::pair(width, 2 * width), std::pair(2 * width, 2 * width)}) {
        const Played played = play_all(options_of(changes("c", "left", left) + changes("d", "right", right)));
        EXPECT_THAT(played.problem, HasSubstr("source gst: the pictures change from 64x48 to 128x48"));
        EXPECT_THAT(played.frames, SizeIs(2));
    }
}

TEST(GstReplay, RowsThatGstreamerPadsHaveNoGaps) {
    constexpr int odd = 130;
    constexpr int stride = 132;  // GStreamer's rows of GRAY8 are multiples of 4
    const TemporaryFolder folder;
    std::string file(std::size_t{stride} * height, '\0');
    std::string expected;
    for (std::size_t i = 0; i < file.size(); ++i) {
        file[i] = static_cast<char>(i * 7 + i / 251);
        expected += i % stride < odd ? std::string(1, file[i]) : "";
    }
    const Played played = play_all(options_of("filesrc location=" + folder.write("raw", file) +
                                              " ! rawvideoparse format=gray8 width=130 height=48 ! appsink"));
    EXPECT_THAT(played.problem, IsEmpty());
    ASSERT_THAT(played.frames, SizeIs(1));
    EXPECT_EQ(std::string(played.frames[0].begin(), played.frames[0].end()), expected);
}

TEST(GstReplay, FramesWithoutNumbersThatAreMissingShowInTheirTimes) {
    if (!has_element("capssetter")) {
        GTEST_SKIP() << "no capssetter: apt-get install gstreamer1.0-plugins-good";
    }
    const TemporaryFolder folder;
    const std::string path = folder.write("raw", std::string(3 * pixels, '\0'));
    for (const auto& [rate, flag] : {std::pair("10", 0U), std::pair("20", 0U + frame_flag_discontinuity)}) {
        const auto source = open_source(options_of(
            "filesrc location=" + path + " ! rawvideoparse format=gray8 width=128 height=48 framerate=10/1 ! " +
            "capssetter caps=video/x-raw,framerate=" + rate + "/1 ! appsink"));
        RawFrame frame;
        for (std::uint64_t i = 0; source->next(frame, test::soon()) == FrameSource::Next::frame; ++i) {
            EXPECT_EQ(frame.sequence, i) << "nobody knows how many are missing";
            EXPECT_EQ(frame.flags, i > 0 ? flag : 0U) << rate;
            source->give_back(frame);
        }
    }
}

TEST(GstReplay, ADescriptorThatDoesNotSayThatItIsLiveIsNoCamera) {
    const TemporaryFolder folder;
    const std::string path = folder.write("raw", std::string(3 * pixels, '\0'));
    const auto play = [&](const std::string& properties, bool daemon) {
        const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        SourceOptions options = options_of("fdsrc fd=" + std::to_string(file) + properties +
                                           " ! rawvideoparse format=gray8 width=128 height=48 ! appsink");
        options.wait_for_camera = daemon;
        Played played = play_all(options);
        ::close(file);
        return played;
    };
    const std::string told = "found a source that does not say that it is live, fdsrc: ";
    EXPECT_THAT(play("", true).problem, HasSubstr(told));
    const Played replay = play("", false);
    EXPECT_FALSE(replay.info.live);
    EXPECT_THAT(replay.notices, ElementsAre(HasSubstr(told)));
    EXPECT_TRUE(play(" do-timestamp=true", false).info.live);
}

TEST(GstReplay, APipeIsNoFileThatCanBePlayedAgain) {
    const TemporaryFolder folder;
    const std::string path = folder.file("pipe");
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    const auto play = [&](const std::string& properties, bool daemon, bool loop) {
        // It holds all three frames, and stays open so that nobody waits for a writer.
        const int pipe = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
        const std::string frames(3 * pixels, '\0');
        EXPECT_EQ(::write(pipe, frames.data(), frames.size()), static_cast<ssize_t>(frames.size()));
        SourceOptions options =
            options_of("filesrc location=" + path + properties + " num-buffers=3 blocksize=" + std::to_string(pixels) +
                       " ! rawvideoparse format=gray8 width=128 height=48 ! appsink");
        options.wait_for_camera = daemon;
        options.loop = loop;
        Played played = play_all(options);
        ::close(pipe);
        return played;
    };
    const std::string told = "found a source that does not say that it is live, filesrc: ";
    EXPECT_THAT(play("", true, false).problem, HasSubstr(told));
    EXPECT_THAT(play("", false, true).problem, HasSubstr("filesrc, which gives its pictures once"));
    const Played replay = play("", false, false);
    EXPECT_THAT(replay.problem, IsEmpty());
    EXPECT_THAT(replay.frames, SizeIs(3));
    EXPECT_THAT(replay.notices, ElementsAre(HasSubstr(told)));
    EXPECT_TRUE(play(" do-timestamp=true", false, false).info.live);
}

TEST(GstReplay, ADaemonPlaysTestSourcesAndFiles) {
    const TemporaryFolder folder;
    std::vector<std::string> pipelines{test_source("num-buffers=2", "10") + "! appsink"};
    if (has_element("pngdec")) {
        test::write_image(folder.file("both.png"), numbered_image(2 * width, height, CV_8UC1, 1));
        pipelines.push_back("uridecodebin uri=file://" + folder.file("both.png") + " ! videoconvert ! appsink");
    }
    for (const std::string& pipeline : pipelines) {
        SourceOptions options = options_of(pipeline);
        options.wait_for_camera = true;
        const Played played = play_all(options);
        EXPECT_THAT(played.problem, IsEmpty());
        EXPECT_FALSE(played.frames.empty());
        EXPECT_THAT(played.notices, IsEmpty());
    }
}

TEST(GstReplay, ALoopPlaysOnUntilItIsInterrupted) {
    SourceOptions options = options_of(test_source("pattern=ball num-buffers=3", "10") + "! appsink");
    options.loop = true;
    options.loans = 1;
    const auto source = open_source(options);
    RawFrame frame;
    for (std::uint64_t i = 0; i < 8; ++i) {
        ASSERT_EQ(source->next(frame, test::soon()), FrameSource::Next::frame);
        EXPECT_EQ(frame.sequence, i);
        EXPECT_EQ(frame.flags, i > 0 && i % 3 == 0 ? frame_flag_discontinuity : 0U);
        source->give_back(frame);
    }
    source->interrupt();
    EXPECT_EQ(source->next(frame, test::soon()), FrameSource::Next::interrupted);
}

}  // namespace
}  // namespace disparityd::capture
