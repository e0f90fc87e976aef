// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <ostream>
#include <span>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/pixel_format.h"
#include "capture/recording/recording_format.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Geometry {
    PixelFormat format;
    int eye_width;
    int height;
};

// What ctest lists; found by GoogleTest.
void PrintTo(const Geometry& geometry, std::ostream* out) {
    *out << to_string(geometry.format) << '_' << geometry.eye_width << 'x' << geometry.height;
}

class RecordRoundTrip : public ::testing::TestWithParam<Geometry> {};

TEST_P(RecordRoundTrip, GivesEveryByteAndFactBack) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a b:c.mkv");
    SourceInfo info = make_info(GetParam().format, GetParam().eye_width, GetParam().height);
    info.calibration = make_calibration(info.eye_width, info.height);
    constexpr int count = 20;
    write_recording(path, info, count);

    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.info.name, path);
    EXPECT_EQ(played.info.format, info.format);
    EXPECT_EQ(played.info.eye_width, info.eye_width);
    EXPECT_EQ(played.info.height, info.height);
    EXPECT_EQ(played.info.rate, info.rate);
    EXPECT_FALSE(played.info.live);
    EXPECT_EQ(played.info.frame_count, std::uint64_t{count});
    ASSERT_TRUE(played.info.calibration.has_value());
    EXPECT_EQ(calibration::to_text(*played.info.calibration), calibration::to_text(*info.calibration));
    EXPECT_EQ(played.info.calibration->left.cx, info.eye_width / 3.0);
    EXPECT_EQ(played.info.calibration->origin, path);
    ASSERT_EQ(played.frames.size(), std::size_t{count});
    for (int i = 0; i < count; ++i) {
        EXPECT_TRUE(played.frames[static_cast<std::size_t>(i)] == seen(make_frame(info, i).frame)) << "frame " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, RecordRoundTrip,
                         ::testing::Values(Geometry{PixelFormat::grey8, 64, 48}, Geometry{PixelFormat::grey8, 45, 37},
                                           Geometry{PixelFormat::grey8, 1, 1}, Geometry{PixelFormat::yuyv, 64, 48},
                                           Geometry{PixelFormat::yuyv, 46, 37}, Geometry{PixelFormat::yuyv, 2, 1},
                                           Geometry{PixelFormat::bgr24, 64, 48}, Geometry{PixelFormat::bgr24, 45, 37},
                                           Geometry{PixelFormat::bgr24, 1, 1}, Geometry{PixelFormat::grey8, 463, 370},
                                           Geometry{PixelFormat::bgr24, 463, 371}));

TEST(Record, TwoReplaysAreIdentical) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::yuyv, 64, 48);
    write_recording(folder.file("r.mkv"), info, 30);
    EXPECT_TRUE(replay(folder.file("r.mkv")).frames == replay(folder.file("r.mkv")).frames);
}

TEST(Record, TheSameFramesGiveTheSameFile) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::bgr24, 33, 21);
    write_recording(folder.file("1.mkv"), info, 10);
    write_recording(folder.file("2.mkv"), info, 10);
    EXPECT_TRUE(file_bytes(folder.file("1.mkv")) == file_bytes(folder.file("2.mkv")));
}

TEST(Record, ARecordingOfARecordingIsTheSame) {
    const TemporaryFolder folder;
    SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    info.calibration = make_calibration(32, 24);
    write_recording(folder.file("1.mkv"), info, 7);
    const Replay first = replay(folder.file("1.mkv"));
    {
        RecordingWriter writer(folder.file("2.mkv"), first.info);
        for (const SeenFrame& frame : first.frames) {
            RawFrame raw;
            raw.image = {frame.pixels.data(), info.format, info.eye_width, info.height, 4 * info.eye_width};
            raw.sequence = frame.sequence;
            raw.monotonic_ns = frame.monotonic_ns;
            raw.realtime_ns = frame.realtime_ns;
            raw.flags = frame.flags;
            raw.dropped_before = frame.dropped_before;
            raw.correction = frame.correction;
            raw.sensors = frame.sensors;
            writer.write(raw);
        }
        writer.close();
    }
    EXPECT_TRUE(replay(folder.file("2.mkv")).frames == first.frames);
}

// What an older version has written ends before the correction.
TEST(Record, FactsWithoutACorrectionAreRead) {
    recording::FrameFacts facts{7, -8, 9, 10, 11, {1, -2, 3, -4}};
    std::array<std::uint8_t, recording::facts_size> bytes{};
    recording::put_facts(facts, bytes);
    const auto whole = recording::get_facts(bytes);
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->correction, facts.correction);
    const auto old = recording::get_facts(std::span(bytes).first(bytes.size() - 16));
    ASSERT_TRUE(old);
    EXPECT_EQ(old->sequence, 7U);
    EXPECT_EQ(old->dropped_before, 11U);
    EXPECT_FALSE(old->correction.any());
    EXPECT_FALSE(recording::get_facts(std::span(bytes).first(bytes.size() - 17)));
}

// Clocks that stand still, run backwards or hold extreme values are written down as they are.
TEST(Record, AnyTimesSurvive) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 4);
    constexpr auto least = std::numeric_limits<std::int64_t>::min();
    constexpr auto most = std::numeric_limits<std::int64_t>::max();
    const std::vector<std::int64_t> times{0, 0, -5, least, most, most, 17, 900'000'000'000, 18, 1'000'000, 1'000'001};
    {
        RecordingWriter writer(path, info);
        for (std::size_t i = 0; i < times.size(); ++i) {
            OwnedFrame made = make_frame(info, static_cast<int>(i));
            made.frame.monotonic_ns = times[i];
            made.frame.realtime_ns = times[times.size() - 1 - i];
            made.frame.sequence = std::numeric_limits<std::uint64_t>::max() - i;
            made.frame.dropped_before = std::numeric_limits<std::uint32_t>::max();
            writer.write(made.frame);
        }
        writer.close();
        EXPECT_EQ(writer.frames(), times.size());
        EXPECT_EQ(writer.bytes(), file_bytes(path).size());
    }
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    ASSERT_EQ(played.frames.size(), times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
        EXPECT_EQ(played.frames[i].monotonic_ns, times[i]);
        EXPECT_EQ(played.frames[i].realtime_ns, times[times.size() - 1 - i]);
        EXPECT_EQ(played.frames[i].sequence, std::numeric_limits<std::uint64_t>::max() - i);
        EXPECT_EQ(played.frames[i].dropped_before, std::numeric_limits<std::uint32_t>::max());
    }
}

TEST(Record, WithoutRateOrCalibrationTheyAreUnknown) {
    const TemporaryFolder folder;
    SourceInfo info = make_info(PixelFormat::yuyv, 32, 24);
    info.rate = 0;
    info.name = "";
    write_recording(folder.file("r.mkv"), info, 2);
    const Replay played = replay(folder.file("r.mkv"));
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames.size(), 2U);
    EXPECT_EQ(played.info.rate, 0);
    EXPECT_FALSE(played.info.calibration.has_value());
}

TEST(Record, ARecordingWithoutFramesIsRefused) {
    const TemporaryFolder folder;
    write_recording(folder.file("r.mkv"), make_info(PixelFormat::yuyv, 32, 24), 0);
    EXPECT_EQ(refusal(folder.file("r.mkv")), folder.file("r.mkv") + ": the recording holds no frames");
}

TEST(Record, AnExistingFileIsRefusedUnlessAllowed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 8, 8);
    write_recording(path, info, 3);
    const auto before = file_bytes(path);
    EXPECT_THAT([&] { RecordingWriter(path, info); },
                ::testing::ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(path), HasSubstr("exists already"))));
    EXPECT_TRUE(file_bytes(path) == before);
    {
        RecordingWriter writer(path, info, true);
        writer.write(make_frame(info, 5).frame);
    }
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    ASSERT_EQ(played.frames.size(), 1U);
    EXPECT_TRUE(played.frames[0] == seen(make_frame(info, 5).frame));
}

TEST(Record, WhatCannotBeRecordedIsRefused) {
    const TemporaryFolder folder;
    EXPECT_THAT([&] { RecordingWriter(folder.file("r.mkv"), make_info(PixelFormat::yuyv, 7, 4)); },
                ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr("found 7 x 4 per eye, allowed an even")));
    EXPECT_THAT([&] { RecordingWriter(folder.file("r.mkv"), make_info(PixelFormat::grey8, 0, 4)); },
                ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr("found 0 x 4 per eye")));
    EXPECT_FALSE(std::filesystem::exists(folder.file("r.mkv")));
    EXPECT_THAT([&] { RecordingWriter(folder.file("no/r.mkv"), make_info(PixelFormat::grey8, 4, 4)); },
                ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("No such file or directory")));
    RecordingWriter writer(folder.file("r.mkv"), make_info(PixelFormat::grey8, 4, 4));
    EXPECT_THAT([&] { writer.write(make_frame(make_info(PixelFormat::grey8, 4, 5), 0).frame); },
                ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr("this frame is grey8 4 x 5 per eye")));
    writer.write(make_frame(make_info(PixelFormat::grey8, 4, 4), 0).frame);
    writer.close();
    EXPECT_EQ(replay(folder.file("r.mkv")).frames.size(), 1U);
    EXPECT_THROW(writer.write(make_frame(make_info(PixelFormat::grey8, 4, 4), 1).frame), std::runtime_error);
}

}  // namespace
}  // namespace disparityd::capture::test
