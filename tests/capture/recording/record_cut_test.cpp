// SPDX-License-Identifier: Apache-2.0
//
// Recordings that another program has cut: "ffmpeg -i whole.mkv -ss A -t B -c copy part.mkv".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

extern "C" {
#include <libavformat/avformat.h>
}

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::HasSubstr;

/// Copies the packets `first` .. `last` with all that the container says, as ffmpeg's "-c copy" does.
void copy_part(const std::string& from, const std::string& to, int first, int last) {
    AVFormatContext* input = nullptr;
    ASSERT_GE(avformat_open_input(&input, from.c_str(), nullptr, nullptr), 0);
    AVFormatContext* output = nullptr;
    ASSERT_GE(avformat_alloc_output_context2(&output, nullptr, "matroska", to.c_str()), 0);
    av_dict_copy(&output->metadata, input->metadata, 0);
    AVStream* stream = avformat_new_stream(output, nullptr);
    avcodec_parameters_copy(stream->codecpar, input->streams[0]->codecpar);
    stream->time_base = input->streams[0]->time_base;
    stream->avg_frame_rate = input->streams[0]->avg_frame_rate;
    ASSERT_GE(avio_open(&output->pb, to.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(output, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    for (int i = 0; av_read_frame(input, packet) >= 0; ++i) {
        if (i >= first && i <= last) {
            av_packet_rescale_ts(packet, input->streams[0]->time_base, stream->time_base);
            ASSERT_GE(av_interleaved_write_frame(output, packet), 0);
        }
        av_packet_unref(packet);
    }
    av_packet_free(&packet);
    ASSERT_GE(av_write_trailer(output), 0);
    avio_closep(&output->pb);
    avformat_free_context(output);
    avformat_close_input(&input);
}

TEST(RecordCut, APartIsWholeByItself) {
    const TemporaryFolder folder;
    SourceInfo info = make_info(PixelFormat::yuyv, 32, 16);
    info.calibration = make_calibration(32, 16);
    write_recording(folder.file("whole.mkv"), info, 20);
    const Replay whole = replay(folder.file("whole.mkv"));
    ASSERT_EQ(whole.frames.size(), 20U);
    EXPECT_EQ(whole.info.frame_count, 20U);

    copy_part(folder.file("whole.mkv"), folder.file("part.mkv"), 5, 11);
    const Replay part = replay(folder.file("part.mkv"));
    EXPECT_EQ(part.error, "");
    EXPECT_FALSE(part.info.frame_count.has_value()) << "that of the whole";
    EXPECT_TRUE(part.info.calibration.has_value());
    EXPECT_EQ(part.frames, std::vector<SeenFrame>(whole.frames.begin() + 5, whole.frames.begin() + 12));
}

TEST(RecordCut, APartThatIsTruncatedItselfIsTold) {
    const TemporaryFolder folder;
    write_recording(folder.file("whole.mkv"), make_info(PixelFormat::grey8, 32, 16), 20);
    copy_part(folder.file("whole.mkv"), folder.file("part.mkv"), 0, 11);
    std::filesystem::resize_file(folder.file("part.mkv"), std::filesystem::file_size(folder.file("part.mkv")) * 2 / 3);
    const Replay part = replay(folder.file("part.mkv"));
    EXPECT_THAT(part.error, HasSubstr("truncated"));
    EXPECT_LT(part.frames.size(), 12U);
}

}  // namespace
}  // namespace disparityd::capture::test
