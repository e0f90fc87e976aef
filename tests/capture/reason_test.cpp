// SPDX-License-Identifier: Apache-2.0
//
// What messages name as the cause: the program's own limits are its own, and what FFmpeg answers is not taken for the
// system's word.
#include <cerrno>
#include <filesystem>
#include <functional>
#include <new>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "base/failure_text.h"
#include "base/text_file.h"
#include "capture/camera/camera_problem.h"
#include "capture/images/image_files.h"
#include "capture/images/image_times.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/open_files_limit.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string failure(const std::function<void()>& call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "nothing failed";
}

std::string failure_to_open(const std::string& uri) {
    return failure([&] {
        SourceOptions options;
        options.uri = uri;
        open_source(options);
    });
}

TEST(Reasons, TooManyOpenFilesAreThisProgramsOwn) {
    const TemporaryFolder folder;
    folder.write("left.txt", "text");
    test::write_image(folder.file("left.png"), test::numbered_image(8, 4, CV_8UC1, 1));
    test::write_image(folder.file("right.png"), test::numbered_image(8, 4, CV_8UC1, 2));
    const SourceInfo info = test::make_info(PixelFormat::grey8, 16, 8);
    test::write_recording(folder.file("a.mkv"), info, 2);
    const std::string calls[] = {
        [&] {
            const test::OpenFilesLimit none;
            return failure([&] { base::read_text_file(folder.file("left.txt"), "calibration"); });
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure([&] { read_image_times(folder.file("left.txt"), 1); });
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure([&] { read_image(folder.file("left.png")); });
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure_to_open(folder.file(""));
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure_to_open(folder.file("%d.png"));
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure_to_open(folder.file("a.mkv"));
        }(),
        [&] {
            const test::OpenFilesLimit none;
            return failure([&] { RecordingWriter(folder.file("b.mkv"), info); });
        }()};
    for (const std::string& said : calls) {
        EXPECT_THAT(said, AllOf(HasSubstr("this program has too many files open"), HasSubstr("ulimit -n"),
                                HasSubstr("LimitNOFILE=")));
        EXPECT_THAT(said, AllOf(Not(HasSubstr("damaged")), Not(HasSubstr("no such"))));
    }
}

TEST(Reasons, NoCameraIsToBlameForTooManyOpenFiles) {
    const VideoError error(VideoError::Call::open, EMFILE,
                           "/dev/video0: cannot be opened: " + base::error_text(EMFILE));
    const CameraProblem problem = diagnose(error, {}, "ZED 2");
    EXPECT_THAT(problem.detail, AllOf(HasSubstr("too many files open"), Not(HasSubstr("plug it in"))));
}

TEST(Reasons, AFailedAllocationIsToldAsSuch) {
    EXPECT_THAT(base::failure_text(std::bad_alloc()), StartsWith("not enough memory: "));
    EXPECT_THAT(base::failure_text(std::length_error("vector::_M_default_append")), StartsWith("not enough memory: "));
    EXPECT_EQ(base::failure_text(std::runtime_error("a.png: is damaged")), "a.png: is damaged");
    EXPECT_EQ(base::failure_text(std::make_exception_ptr(7)), "an unknown failure");
    EXPECT_THAT(
        base::failure_text(cv::Exception(cv::Error::StsNoMem, "Failed to allocate 9 bytes", "f", "alloc.cpp", 7)),
        StartsWith("not enough memory: "));
    EXPECT_EQ(base::failure_text(cv::Exception(cv::Error::StsAssert, "x > 0", "f", "any.cpp", 7)), "x > 0");
}

TEST(Reasons, WhatIsNoVideoIsNotToldAsTheSystemsRefusal) {
    const TemporaryFolder folder;
    test::write_image(folder.file("picture.png"), test::numbered_image(8, 4, CV_8UC1, 1));
    std::filesystem::rename(folder.file("picture.png"), folder.file("picture.mkv"));
    folder.write("header.y4m", "YUV4MPEG2 W0 H4\n");
    folder.write("long.y4m", "YUV4MPEG2 W16" + std::string(3000, ' '));
    folder.write("short.ogv", "OggS");
    folder.write("text.mkv", "this is no video");
    std::string noise;
    std::uint32_t random = 7;
    for (int i = 0; i < 40; ++i) {
        noise.clear();
        while (noise.size() < 5000) {
            random = random * 1664525 + 1013904223;
            noise += static_cast<char>(random >> 24);
        }
        folder.write("noise" + std::to_string(i) + ".mpg", noise);
    }
    for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
        const std::string said = failure_to_open(file.path().string());
        EXPECT_THAT(said, HasSubstr(file.path().filename().string()));
        for (const char* system : {"Operation not permitted", "Invalid argument", "Device or resource busy",
                                   "End of file", "whitelist", "Invalid data found"}) {
            EXPECT_THAT(said, Not(HasSubstr(system)));
        }
    }
    EXPECT_THAT(failure_to_open(folder.file("picture.mkv")),
                HasSubstr("is an image (PNG): give that of each eye, with names that end in .png"));
}

}  // namespace
}  // namespace disparityd::capture
