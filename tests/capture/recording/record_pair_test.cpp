// SPDX-License-Identifier: Apache-2.0
// A video for each eye, a track for each eye, and what a video declares about its pictures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

extern "C" {
#include <libavutil/display.h>
#include <libavutil/spherical.h>
}

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/recording/recording_source.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/capture/recording/video_fixture.h"

namespace disparityd::capture::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Video eye_of(int frames = 5) {
    Video video{"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, 32, 24};
    video.frames = frames;
    return video;
}

std::vector<std::string> notices_of(const std::string& uri) {
    std::vector<std::string> notices;
    SourceOptions options;
    options.uri = uri;
    options.report = [&notices](const std::string& line, bool) { notices.push_back(line); };
    open_source(options);
    return notices;
}

/// Both eyes as write_video() draws them; the right one `brighter`.
void expect_pairs(const Replay& played, std::size_t count, int brighter) {
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.info.eye_width, 32);
    EXPECT_EQ(played.info.height, 24);
    EXPECT_EQ(played.info.rate, video_rate);
    ASSERT_EQ(played.frames.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
        const SeenFrame& frame = played.frames[i];
        EXPECT_EQ(frame.sequence, i);
        EXPECT_EQ(frame.monotonic_ns, static_cast<std::int64_t>(i) * 1'000'000'000 / video_rate);
        for (const int y : {0, 23}) {
            for (const int x : {0, 31}) {
                const auto at = static_cast<std::size_t>(64 * y + x);
                const int left = value_at(static_cast<int>(i), 0, x, y);
                EXPECT_EQ(frame.pixels[at], left);
                EXPECT_EQ(frame.pixels[at + 32], left + brighter);
            }
        }
    }
}

TEST(RecordPair, TwoFilesAreAPair) {
    const TemporaryFolder folder;
    write_video(folder.file("left, a.mkv"), eye_of());
    write_video(folder.file("right b.mkv"), eye_of(6));  // which camera stops first is chance
    const std::string uri = folder.file("left, a.mkv") + "," + folder.file("right b.mkv");
    ASSERT_TRUE(is_recording(uri));
    expect_pairs(replay(uri), 5, 0);
    EXPECT_EQ(replay(uri, true, 12).frames.size(), 12U) << "in a loop";
    write_video(folder.file("both%d.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, 64, 24});
    EXPECT_THAT(notices_of(folder.file("both%d.mkv")), ElementsAre(HasSubstr("no stereo layout"))) << "is no pattern";
}

TEST(RecordPair, TwoTracksAreAPair) {
    const TemporaryFolder folder;
    Video video = eye_of();
    video.tracks = 2;
    write_video(folder.file("a.mkv"), video);
    expect_pairs(replay(folder.file("a.mkv")), 5, 60);
    EXPECT_THAT(notices_of(folder.file("a.mkv")), ElementsAre(HasSubstr("the first is taken as the left eye")));
    video.adjust = [](AVStream& stream, int track) {
        av_dict_set(&stream.metadata, "title", track == 0 ? "Left eye" : "Right eye", 0);
    };
    write_video(folder.file("b.mkv"), video);
    expect_pairs(replay(folder.file("b.mkv")), 5, 60);
    EXPECT_THAT(notices_of(folder.file("b.mkv")), IsEmpty());
}

TEST(RecordPair, TracksThatAreNamedTheOtherWayRoundAreExchanged) {
    const TemporaryFolder folder;
    Video video = eye_of();
    video.tracks = 2;
    video.adjust = [](AVStream& stream, int track) {
        av_dict_set(&stream.metadata, "title", track == 0 ? "right" : "left", 0);
    };
    write_video(folder.file("a.mkv"), video);
    const Replay played = replay(folder.file("a.mkv"));
    ASSERT_EQ(played.frames.size(), 5U);
    EXPECT_EQ(played.frames[0].pixels[0], value_at(0, 0, 0, 0) + 60);
    EXPECT_EQ(played.frames[0].pixels[32], value_at(0, 0, 0, 0));
}

// A name of one track is enough; names that contradict each other are none.
TEST(RecordPair, OneNamedTrackSaysWhichEyeItIs) {
    struct Names {
        const char* first;
        const char* second;
        bool exchanged;
        bool told;
    };
    for (const Names& names : {Names{"Right camera", "", true, false},
                               {"", "LEFT", true, false},
                               {"cam-left", "", false, false},
                               {"", "right", false, false},
                               {"left", "left", false, true}}) {
        SCOPED_TRACE(std::string(names.first) + "|" + names.second);
        const TemporaryFolder folder;
        Video video = eye_of();
        video.tracks = 2;
        video.adjust = [&](AVStream& stream, int track) {
            av_dict_set(&stream.metadata, "title", track == 0 ? names.first : names.second, 0);
        };
        write_video(folder.file("a.mkv"), video);
        EXPECT_EQ(replay(folder.file("a.mkv")).frames.at(0).pixels[0],
                  value_at(0, 0, 0, 0) + (names.exchanged ? 60 : 0));
        EXPECT_EQ(notices_of(folder.file("a.mkv")).size(), names.told ? 1U : 0U);
    }
}

TEST(RecordPair, ThreeTracksAndUnlikeVideosAreRefused) {
    const TemporaryFolder folder;
    Video depth = eye_of();
    depth.tracks = 2;
    depth.adjust = [](AVStream& stream, int track) {
        av_dict_set(&stream.metadata, "title", track == 0 ? "COLOR" : "DEPTH", 0);
    };
    write_video(folder.file("depth.mkv"), depth);
    EXPECT_THAT(refusal(folder.file("depth.mkv")), HasSubstr("has a track that is called depth"));
    Video three = eye_of();
    three.tracks = 3;
    write_video(folder.file("three.mkv"), three);
    EXPECT_THAT(refusal(folder.file("three.mkv")), HasSubstr("has 3 video streams"));
    write_video(folder.file("l.mkv"), eye_of());
    write_video(folder.file("r.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, 34, 24});
    EXPECT_THAT(refusal(folder.file("l.mkv") + "," + folder.file("r.mkv")),
                AllOf(HasSubstr("must be alike"), HasSubstr("32x24"), HasSubstr("34x24")));
    EXPECT_THAT(refusal(folder.file("l.mkv") + "," + folder.file("missing.mkv")),
                HasSubstr("/missing.mkv: cannot open the recording: No such file"));
    EXPECT_THAT(refusal(folder.file("l.mkv") + "," + folder.file("l.mkv")), HasSubstr("is named for both eyes"));
    EXPECT_THAT(refusal(folder.file("l.svo") + "," + folder.file("r.mkv")), HasSubstr("l.svo")) << "the first is told";
    write_recording(folder.file("both.mkv"), make_info(PixelFormat::grey8, 32, 24), 2);
    EXPECT_THAT(refusal(folder.file("l.mkv") + "," + folder.file("both.mkv")),
                HasSubstr("is a recording of both eyes"));
}

TEST(RecordPair, AnEyeThatEndsMuchEarlierIsTold) {
    const TemporaryFolder folder;
    write_video(folder.file("l.mkv"), eye_of(10));
    write_video(folder.file("r.mkv"), eye_of(10 + video_rate + 2));
    const Replay played = replay(folder.file("l.mkv") + "," + folder.file("r.mkv"));
    EXPECT_EQ(played.frames.size(), 10U);
    EXPECT_THAT(played.error, HasSubstr("the video of the left eye ends first, by more than a second: 10 pairs"));
}

// Half of a picture is no eye: its depth would look certain and mean nothing.
TEST(RecordPair, TheVideoOfOneEyeIsNotCutInTwo) {
    const TemporaryFolder folder;
    write_video(folder.file("left.mkv"), eye_of());
    EXPECT_THAT(refusal(folder.file("left.mkv")), AllOf(HasSubstr("found a picture of 32x24, which is that of one eye"),
                                                        HasSubstr("left.mp4,right.mp4")));
    write_video(folder.file("wide.mkv"), {"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, 64, 24});
    EXPECT_THAT(notices_of(folder.file("wide.mkv")), ElementsAre(HasSubstr("declares no stereo layout")));
}

Video declared(const char* layout, int width, int height) {
    Video video{"matroska", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY8, width, height};
    video.adjust = [layout](AVStream& stream, int) { av_dict_set(&stream.metadata, "stereo_mode", layout, 0); };
    return video;
}

TEST(RecordPair, ADeclaredLayoutIsObeyedOrRefused) {
    const TemporaryFolder folder;
    write_video(folder.file("sbs.mkv"), declared("left_right", 32, 24));  // narrow eyes, but it says so
    EXPECT_EQ(replay(folder.file("sbs.mkv")).frames.size(), 5U);
    EXPECT_THAT(notices_of(folder.file("sbs.mkv")), IsEmpty());
    for (const char* layout : {"right_left", "top_bottom", "bottom_top", "row_interleaved_lr"}) {
        SCOPED_TRACE(layout);
        write_video(folder.file("other.mkv"), declared(layout, 64, 24));
        EXPECT_THAT(refusal(folder.file("other.mkv")),
                    AllOf(HasSubstr("declares the stereo layout"), HasSubstr("stereo3d")));
    }
}

std::uint8_t* new_side_data(AVStream& stream, AVPacketSideDataType type, std::size_t size) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 102)
    return av_packet_side_data_new(&stream.codecpar->coded_side_data, &stream.codecpar->nb_coded_side_data, type, size,
                                   0)
        ->data;
#else
    return av_stream_new_side_data(&stream, type, size);
#endif
}

TEST(RecordPair, ADeclaredRotationIsRefused) {
    const TemporaryFolder folder;
    for (const double angle : {90.0, 180.0, -90.0, 30.0}) {
        SCOPED_TRACE(angle);
        Video video{"mp4", AV_CODEC_ID_MPEG4, AV_PIX_FMT_YUV420P, 64, 24};
        video.adjust = [angle](AVStream& stream, int) {
            std::uint8_t* const matrix = new_side_data(stream, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(std::int32_t));
            av_display_rotation_set(reinterpret_cast<std::int32_t*>(matrix), angle);
        };
        write_video(folder.file("a.mp4"), video);
        const std::string said = "declares that its pictures are to be turned by ";
        EXPECT_THAT(refusal(folder.file("a.mp4")), HasSubstr(said));
        write_video(folder.file("plain.mp4"), {"mp4", AV_CODEC_ID_MPEG4, AV_PIX_FMT_YUV420P, 64, 24});
        EXPECT_THAT(refusal(folder.file("plain.mp4") + "," + folder.file("a.mp4")),
                    AllOf(HasSubstr("a.mp4: "), HasSubstr(said)))
            << "of one eye alone";
    }
}

TEST(RecordPair, ADeclaredSphereIsRefused) {
    const TemporaryFolder folder;
    for (const AVSphericalProjection projection : {AV_SPHERICAL_EQUIRECTANGULAR, AV_SPHERICAL_CUBEMAP}) {
        Video video = declared("left_right", 64, 24);
        const auto stereo = video.adjust;
        video.adjust = [&](AVStream& stream, int track) {
            stereo(stream, track);
            std::size_t size = 0;
            AVSphericalMapping* const sphere = av_spherical_alloc(&size);
            sphere->projection = projection;
            std::memcpy(new_side_data(stream, AV_PKT_DATA_SPHERICAL, size), sphere, size);
            av_free(sphere);
        };
        write_video(folder.file("a.mkv"), video);
        EXPECT_THAT(refusal(folder.file("a.mkv")), AllOf(HasSubstr("parts of a sphere"), HasSubstr("v360")));
    }
}

TEST(RecordPair, FilesOfOtherRecordersAreNamed) {
    const TemporaryFolder folder;
    struct File {
        const char* name;
        std::string begins;
        const char* said;
    };
    const File files[] = {{"a.svo", std::string("\0SVO", 4), "recording of the ZED SDK before 4.1 (SVO 1)"},
                          {"a.svo2", "\x89MCAP0\r\n", "recording of the ZED SDK (SVO2), which holds both eyes"},
                          {"bag.dat", "#ROSBAG V2.0\n", "is a ROS bag"},
                          {"db3.dat", std::string("SQLite format 3\0", 16), "is a ROS bag"},
                          {"a.log", "\x89MCAP0\r\n", "is an MCAP file: give it a name that ends in .mcap"},
                          {"a.zip", "PK\x03\x04", "is a ZIP archive"},
                          {"a.mkv", "\x1f\x8b\x08", "is compressed with gzip"},
                          {"a.gif", "GIF89a", "is an image of a kind that is not read; convert it"},
                          {"a.heic",
                           std::string("\0\0\0\x18"
                                       "ftypheic",
                                       12),
                           "is an image of a kind"},
                          {"a.pfm", "Pf\n4 3\n", "is an image of a kind"},
                          {"a.dng", std::string("II*\0", 4), "raw data of a camera"}};
    for (const File& file : files) {
        SCOPED_TRACE(file.name);
        std::vector<std::uint8_t> bytes(20'000, 0xA5);
        std::memcpy(bytes.data(), file.begins.data(), file.begins.size());
        put_file(folder.file(file.name), bytes.data(), bytes.size());
        EXPECT_THAT(refusal(folder.file(file.name)), HasSubstr(file.said));
    }
}

}  // namespace
}  // namespace disparityd::capture::test
