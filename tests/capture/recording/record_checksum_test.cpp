// SPDX-License-Identifier: Apache-2.0
// Recordings in which bits have changed: no other picture, time or number is shown than what was recorded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "capture/recording/recording_checksum.h"
#include "capture/recording/recording_format.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr int frames_written = 12;

/// Camera pictures are noisy: a flipped bit of noise is a legal other picture.
OwnedFrame noisy(const SourceInfo& info, int number) {
    return make_frame(info, 2 * number + 1);
}

void write_noise(const std::string& path, const SourceInfo& info) {
    RecordingWriter writer(path, info);
    for (int i = 0; i < frames_written; ++i) {
        writer.write(noisy(info, i).frame);
    }
    writer.close();
}

/// Returns whether the frame was recorded like this. What was lost before it may be more by now.
bool was_recorded(const SeenFrame& shown, const SourceInfo& info) {
    for (int i = 0; i < frames_written; ++i) {
        const SeenFrame recorded = seen(noisy(info, i).frame);
        if (recorded.sequence == shown.sequence) {
            SeenFrame same = shown;
            same.dropped_before = recorded.dropped_before;
            for (std::size_t s = 0; s < std::min(same.sensors.size(), recorded.sensors.size()); ++s) {
                same.sensors[s].lost_before = recorded.sensors[s].lost_before;
            }
            return same == recorded;
        }
    }
    return false;
}

TEST(RecordChecksum, IsTheOneThatOthersKnow) {
    constexpr std::string_view digits = "123456789";
    std::array<std::uint8_t, 9> bytes{};
    std::copy(digits.begin(), digits.end(), bytes.begin());
    EXPECT_EQ(recording::checksum(bytes), 0xCBF43926U);
    const SourceInfo info = make_info(PixelFormat::bgr24, 5, 3);
    const OwnedFrame frame = make_frame(info, 1);
    EXPECT_EQ(recording::checksum(frame.frame.image), recording::checksum(seen(frame.frame).pixels)) << "gaps count";
}

TEST(RecordChecksum, AFlippedBitIsNeverShown) {
    const TemporaryFolder folder;
    std::size_t told = 0;
    std::size_t rounds = 0;
    for (const PixelFormat format : {PixelFormat::yuyv, PixelFormat::grey8, PixelFormat::bgr24}) {
        SourceInfo info = make_info(format, 48, 20);
        info.calibration = make_calibration(48, 20);
        const std::string whole = folder.file(std::to_string(static_cast<int>(format)) + ".mkv");
        write_noise(whole, info);
        const std::vector<std::uint8_t> bytes = file_bytes(whole);
        const std::string calibration = calibration::to_text(*info.calibration);
        for (std::size_t at = 5; at < bytes.size(); at += at < 4000 ? 61 : 601, ++rounds) {
            SCOPED_TRACE(std::to_string(at) + " of " + std::to_string(bytes.size()));
            std::vector<std::uint8_t> damaged = bytes;
            damaged[at] ^= static_cast<std::uint8_t>(1U << (at % 8));
            put_file(folder.file("flipped.mkv"), damaged.data(), damaged.size());
            try {
                const Replay played = replay(folder.file("flipped.mkv"));
                EXPECT_TRUE(std::all_of(played.frames.begin(), played.frames.end(),
                                        [&](const SeenFrame& frame) { return was_recorded(frame, info); }));
                EXPECT_TRUE(played.frames.size() == frames_written || !played.error.empty());
                ASSERT_TRUE(played.info.calibration);
                EXPECT_EQ(calibration::to_text(*played.info.calibration), calibration);
                told += played.error.empty() ? 0U : 1U;
            } catch (const std::invalid_argument&) {
                ++told;
            }
        }
    }
    EXPECT_GT(told, rounds / 3) << "many bytes are those of frames";
}

// In the middle of a frame's data: it alone is missing, the others and what was lost are known.
TEST(RecordChecksum, ADamagedFrameIsLeftOutAndCounted) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    const SourceInfo info = make_info(PixelFormat::yuyv, 64, 48);
    write_noise(path, info);
    std::vector<std::uint8_t> bytes = file_bytes(path);
    bytes[bytes.size() / 2] ^= 0x10U;
    put_file(path, bytes.data(), bytes.size());
    const Replay played = replay(path);
    EXPECT_EQ(played.error, path +
                                ": damaged: 11 of 12 frames could be read, 1 frame was left out, the first because "
                                "its pixels are not those that were recorded");
    ASSERT_EQ(played.frames.size(), std::size_t{frames_written} - 1);
    std::size_t gaps = 0;
    for (std::size_t i = 1; i < played.frames.size(); ++i) {
        const SeenFrame& frame = played.frames[i];
        EXPECT_EQ(frame.sequence, played.frames[i - 1].sequence + 1 + frame.dropped_before);
        gaps += frame.dropped_before > 5 ? 1U : 0U;  // of each second frame 5 were lost when it was recorded
    }
    EXPECT_EQ(gaps, 1U);
}

TEST(RecordChecksum, ADamagedTimeIsNotShown) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    const SourceInfo info = make_info(PixelFormat::grey8, 16, 8);
    write_noise(path, info);
    std::vector<std::uint8_t> bytes = file_bytes(path);
    constexpr std::string_view magic = "dispfrm1";
    const auto first = std::search(bytes.begin(), bytes.end(), magic.begin(), magic.end());
    ASSERT_NE(first, bytes.end());
    first[20] ^= 0x40U;  // of its CLOCK_MONOTONIC
    put_file(path, bytes.data(), bytes.size());
    const Replay played = replay(path);
    EXPECT_THAT(played.error, AllOf(HasSubstr("1 frame was left out"), EndsWith("times are missing or not those that "
                                                                                "were recorded")));
    ASSERT_EQ(played.frames.size(), std::size_t{frames_written} - 1);
    EXPECT_TRUE(played.frames[0] == seen(noisy(info, 1).frame) || played.frames[0].dropped_before > 0);
}

/// Writes a recording again as versions without checksums did.
void write_as_before(const std::string& from, const std::string& to) {
    AVFormatContext* input = nullptr;
    ASSERT_GE(avformat_open_input(&input, from.c_str(), nullptr, nullptr), 0);
    AVFormatContext* output = nullptr;
    ASSERT_GE(avformat_alloc_output_context2(&output, nullptr, "matroska", to.c_str()), 0);
    output->flags |= AVFMT_FLAG_BITEXACT;  // as our writer: no other program's name
    av_dict_copy(&output->metadata, input->metadata, 0);
    av_dict_set(&output->metadata, recording::tag_checksums, nullptr, 0);
    AVStream* stream = avformat_new_stream(output, nullptr);
    avcodec_parameters_copy(stream->codecpar, input->streams[0]->codecpar);
    stream->time_base = input->streams[0]->time_base;
    ASSERT_GE(avio_open(&output->pb, to.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(output, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    while (av_read_frame(input, packet) >= 0) {
        ASSERT_GE(av_packet_shrink_side_data(packet, AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, recording::facts_size), 0);
        av_packet_rescale_ts(packet, input->streams[0]->time_base, stream->time_base);
        ASSERT_GE(av_write_frame(output, packet), 0);
        av_packet_unref(packet);
    }
    av_packet_free(&packet);
    ASSERT_GE(av_write_trailer(output), 0);
    avio_closep(&output->pb);
    avformat_free_context(output);
    avformat_close_input(&input);
}

TEST(RecordChecksum, RecordingsOfBeforeStillPlay) {
    const TemporaryFolder folder;
    const SourceInfo info = make_info(PixelFormat::yuyv, 32, 16);
    write_noise(folder.file("new.mkv"), info);
    write_as_before(folder.file("new.mkv"), folder.file("old.mkv"));
    EXPECT_LT(file_bytes(folder.file("old.mkv")).size(), file_bytes(folder.file("new.mkv")).size());
    const Replay played = replay(folder.file("old.mkv"));
    EXPECT_EQ(played.error, "");
    ASSERT_EQ(played.frames.size(), std::size_t{frames_written});
    for (int i = 0; i < frames_written; ++i) {
        SeenFrame recorded = seen(noisy(info, i).frame);
        recorded.sensors.clear();
        recorded.dropped_before = played.frames[static_cast<std::size_t>(i)].dropped_before;
        EXPECT_TRUE(played.frames[static_cast<std::size_t>(i)] == recorded) << i;
    }
}

TEST(RecordChecksum, ARecordingWithoutTheTagOfItsFormatIsNoVideoOfAnotherProgram) {
    const TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    write_noise(path, make_info(PixelFormat::yuyv, 32, 16));
    std::vector<std::uint8_t> bytes = file_bytes(path);
    const std::string_view tag = recording::tag_format;
    const auto at = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end());
    ASSERT_NE(at, bytes.end());
    at[0] ^= 0x04U;
    put_file(path, bytes.data(), bytes.size());
    EXPECT_THAT(refusal(path), StartsWith(path + ": the recording is damaged: its tag DISPARITYD_FORMAT is missing"));
}

}  // namespace
}  // namespace disparityd::capture::test
