// SPDX-License-Identifier: Apache-2.0
// Videos that others made, and files that are no videos.
#include <cstdlib>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/recording/recording_source.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/capture/recording/video_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::HasSubstr;

/// Plays the video and compares each byte with what `expected` says, within `tolerance`.
void expect_frames(const std::string& path, const Video& video, PixelFormat format, int tolerance,
                   const std::function<int(int frame, int byte, int y)>& expected) {
    const Replay played = replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.info.format, format);
    EXPECT_EQ(played.info.eye_width, video.width / 2);
    EXPECT_EQ(played.info.height, video.height);
    EXPECT_DOUBLE_EQ(played.info.rate, video_rate);
    EXPECT_FALSE(played.info.calibration.has_value());
    ASSERT_EQ(played.frames.size(), static_cast<std::size_t>(video.frames));
    const int row = video.width * bytes_per_pixel(format);
    int worst = 0;
    for (int i = 0; i < video.frames; ++i) {
        const SeenFrame& frame = played.frames[static_cast<std::size_t>(i)];
        EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(i));
        EXPECT_EQ(frame.monotonic_ns, i * 1'000'000'000LL / video_rate);
        EXPECT_EQ(frame.flags, 0U);
        EXPECT_EQ(frame.dropped_before, 0U);
        for (int y = 0; y < video.height; ++y) {
            for (int x = 0; x < row; ++x) {
                worst =
                    std::max(worst, std::abs(expected(i, x, y) - frame.pixels[static_cast<std::size_t>(y * row + x)]));
            }
        }
    }
    EXPECT_LE(worst, tolerance);
}

int luma(int frame, int x, int y) {
    return value_at(frame, 0, x, y);
}

int yuyv(int frame, int byte, int y) {
    return byte % 2 == 0 ? value_at(frame, 0, byte / 2, y) : value_at(frame, byte % 4 == 1 ? 1 : 2, byte / 4, y);
}

int bgr(int frame, int byte, int y) {
    return value_at(frame, 2 - byte % 3, byte / 3, y);
}

TEST(RecordForeign, LumaOfPlanarVideoIsGrey) {
    const TemporaryFolder folder;
    const Video raw{"avi", AV_CODEC_ID_RAWVIDEO, AV_PIX_FMT_YUV420P, 64, 32};
    write_video(folder.file("a.avi"), raw);
    expect_frames(folder.file("a.avi"), raw, PixelFormat::grey8, 0, luma);
    const Video jpeg{"avi", AV_CODEC_ID_MJPEG, AV_PIX_FMT_YUVJ420P, 64, 32};
    write_video(folder.file("j.avi"), jpeg);
    expect_frames(folder.file("j.avi"), jpeg, PixelFormat::grey8, 20, luma);
}

TEST(RecordForeign, PredictedFramesComeInOrder) {
    const TemporaryFolder folder;
    const Video video{"mp4", AV_CODEC_ID_MPEG4, AV_PIX_FMT_YUV420P, 64, 32, 30};
    write_video(folder.file("a.mp4"), video);
    expect_frames(folder.file("a.mp4"), video, PixelFormat::grey8, 60, luma);
    EXPECT_EQ(replay(folder.file("a.mp4")).info.frame_count, 30U);
}

TEST(RecordForeign, FourTwoTwoIsYuyv) {
    const TemporaryFolder folder;
    const Video planar{"matroska", AV_CODEC_ID_UTVIDEO, AV_PIX_FMT_YUV422P, 64, 31};
    write_video(folder.file("p.mkv"), planar);
    expect_frames(folder.file("p.mkv"), planar, PixelFormat::yuyv, 0, yuyv);
    const Video packed{"avi", AV_CODEC_ID_RAWVIDEO, AV_PIX_FMT_YUYV422, 64, 31};
    write_video(folder.file("q.avi"), packed);
    expect_frames(folder.file("q.avi"), packed, PixelFormat::yuyv, 0, yuyv);
}

TEST(RecordForeign, ColourIsBgr) {
    const TemporaryFolder folder;
    const Video planar{"matroska", AV_CODEC_ID_UTVIDEO, AV_PIX_FMT_GBRP, 30, 11};
    write_video(folder.file("p.mkv"), planar);
    expect_frames(folder.file("p.mkv"), planar, PixelFormat::bgr24, 0, bgr);
    const Video packed{"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_BGR0, 30, 11};
    write_video(folder.file("q.mkv"), packed);
    expect_frames(folder.file("q.mkv"), packed, PixelFormat::bgr24, 0, bgr);
}

TEST(RecordForeign, AWidthThatDoesNotSplitIsRefused) {
    const TemporaryFolder folder;
    write_video(folder.file("odd.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, 33, 8});
    EXPECT_THAT(refusal(folder.file("odd.mkv")), HasSubstr("found a picture 33 pixels wide, expected two eyes"));
    write_video(folder.file("yuyv.avi"), {"avi", AV_CODEC_ID_RAWVIDEO, AV_PIX_FMT_YUYV422, 34, 8});
    EXPECT_THAT(refusal(folder.file("yuyv.avi")), HasSubstr("found a YUV 4:2:2 picture 34 pixels wide"));
    EXPECT_THAT(refusal(folder.file("yuyv.avi")), HasSubstr("a multiple of 4"));
}

TEST(RecordForeign, ACutVideoSaysSo) {
    const TemporaryFolder folder;
    write_video(folder.file("a.avi"), {"avi", AV_CODEC_ID_RAWVIDEO, AV_PIX_FMT_YUV420P, 64, 32, 10});
    write_video(folder.file("m.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_YUV420P, 64, 32, 10});
    for (const char* name : {"a.avi", "m.mkv"}) {
        SCOPED_TRACE(name);
        const auto bytes = file_bytes(folder.file(name));
        put_file(folder.file(name), bytes.data(), bytes.size() * 6 / 10);
        const Replay played = replay(folder.file(name));
        EXPECT_GT(played.frames.size(), 3U);
        EXPECT_LT(played.frames.size(), 10U);
        EXPECT_THAT(played.error, HasSubstr("truncated"));
    }
}

TEST(RecordForeign, WhatIsNoVideoIsRefused) {
    const TemporaryFolder folder;
    EXPECT_THAT(refusal(folder.file("missing.mkv")), HasSubstr("missing.mkv: cannot open the recording: "));
    EXPECT_THAT(refusal(folder.file("")), HasSubstr("is not a file"));
    put_file(folder.file("empty.mkv"), nullptr, 0);
    EXPECT_THAT(refusal(folder.file("empty.mkv")), HasSubstr("empty.mkv: is empty"));
    const std::string html = "<!DOCTYPE html>\n<html><body>not found</body></html>\n";
    for (const char* name : {"page.mkv", "page.html", "page.txt"}) {
        put_file(folder.file(name), reinterpret_cast<const std::uint8_t*>(html.data()), html.size());
        EXPECT_THAT(refusal(folder.file(name)), HasSubstr(std::string(name) + ": is not a"));
    }
    std::vector<std::uint8_t> noise(20000);
    std::uint32_t random = 7;
    for (std::uint8_t& byte : noise) {
        random = random * 1664525 + 1013904223;
        byte = static_cast<std::uint8_t>(random >> 24);
    }
    put_file(folder.file("noise.mkv"), noise.data(), noise.size());
    EXPECT_THAT(refusal(folder.file("noise.mkv")), HasSubstr("noise.mkv: "));
}

TEST(RecordForeign, AHoleInATransportStreamIsNotItsEnd) {
    const TemporaryFolder folder;
    write_video(folder.file("a.ts"), {"mpegts", AV_CODEC_ID_MPEG2VIDEO, AV_PIX_FMT_YUV420P, 64, 32, 12});
    const auto bytes = file_bytes(folder.file("a.ts"));
    // Twice the same stream: its counters do not go on where the second one begins.
    std::vector<std::uint8_t> twice(bytes.begin(), bytes.end());
    twice.insert(twice.end(), bytes.begin(), bytes.end());
    put_file(folder.file("b.ts"), twice.data(), twice.size());
    const Replay played = replay(folder.file("b.ts"));
    EXPECT_GT(played.frames.size(), 16U);
    EXPECT_EQ(played.error, "");
}

TEST(RecordForeign, APlaylistOpensNoOtherFile) {
    const TemporaryFolder folder;
    write_video(folder.file("a.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_YUV420P, 64, 32, 3});
    const std::string lists[] = {"ffconcat version 1.0\nfile a.mkv\n",
                                 "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\na.mkv\n#EXT-X-ENDLIST\n"};
    for (const std::string& list : lists) {
        put_file(folder.file("list.mkv"), reinterpret_cast<const std::uint8_t*>(list.data()), list.size());
        EXPECT_THAT(refusal(folder.file("list.mkv")), HasSubstr("list.mkv: is not a recording or another video"));
    }
}

TEST(RecordForeign, SoundHasNoPicture) {
    const TemporaryFolder folder;
    // A WAV file of silence, written by hand: 44 bytes of header, mono, 8 bits.
    std::vector<std::uint8_t> wav(44 + 8000, 128);
    const std::uint8_t header[44] = {'R', 'I', 'F', 'F', 0x64, 0x1F, 0,   0,   'W', 'A',  'V',  'E',  'f', 'm',  't',
                                     ' ', 16,  0,   0,   0,    1,    0,   1,   0,   0x40, 0x1F, 0,    0,   0x40, 0x1F,
                                     0,   0,   1,   0,   8,    0,    'd', 'a', 't', 'a',  0x40, 0x1F, 0,   0};
    std::copy(std::begin(header), std::end(header), wav.begin());
    put_file(folder.file("sound.wav"), wav.data(), wav.size());
    EXPECT_THAT(refusal(folder.file("sound.wav")), HasSubstr("has no video stream"));
}

TEST(RecordForeign, NamesOfVideosAreKnown) {
    EXPECT_TRUE(is_recording("some/where.mkv"));
    EXPECT_TRUE(is_recording("CLIP.MP4"));
    EXPECT_FALSE(is_recording("scene:vga"));
    EXPECT_FALSE(is_recording("/"));
    EXPECT_FALSE(is_recording("left_%06d.png"));
}

}  // namespace
}  // namespace disparityd::capture::test
