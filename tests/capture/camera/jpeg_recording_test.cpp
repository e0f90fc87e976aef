// SPDX-License-Identifier: Apache-2.0
//
// A recording of a camera that sends JPEGs keeps their bytes, and shows the pixels that the camera's frames had.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <turbojpeg.h>

#include "capture/camera/camera_source.h"
#include "capture/recording/recorder.h"
#include "capture/recording/recording_writer.h"
#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/camera/made_jpeg.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using test::Bytes;
using test::FakeVideoSystem;
using test::Replay;
using test::seen;
using test::SeenFrame;

constexpr int picture_width = 128;
constexpr int picture_height = 64;
constexpr std::size_t pictures = 5;

class JpegRecordingTest : public ::testing::Test {
protected:
    JpegRecordingTest() {
        auto camera = test::zed2();
        camera.width = picture_width;
        camera.height = picture_height;
        camera.format = V4L2_PIX_FMT_MJPEG;
        for (unsigned seed = 0; seed < pictures; ++seed) {
            jpegs_.push_back(test::made_jpeg(picture_width, picture_height, TJSAMP_420, seed));
        }
        camera.jpegs = jpegs_;
        system_.plug(camera);
    }

    void open(const std::string& options = "") {
        SourceOptions wanted;
        wanted.uri = "v4l2:128x64@30?format=mjpeg" + options;
        wanted.decoders = 0;
        source_ = open_camera_on(system_, wanted);
    }

    /// Gives each of so many frames to `take`.
    template <typename Take>
    void for_frames(std::size_t count, const Take& take) {
        for (std::size_t i = 0; i < count;) {
            RawFrame frame;
            ASSERT_LT(system_.now().time_since_epoch(), 1h + 1min);
            if (source_->next(frame, system_.now() + 1s) == FrameSource::Next::frame) {
                take(frame);
                source_->give_back(frame);
                ++i;
            }
        }
    }

    /// Records so many frames and returns them as they were live.
    std::vector<SeenFrame> record(std::size_t count) {
        std::vector<SeenFrame> live;
        RecordingWriter writer(path_, source_->info());
        for_frames(count, [&](const RawFrame& frame) {
            live.push_back(seen(frame));
            writer.write(frame);
        });
        writer.close();
        return live;
    }

    bool file_holds(const Bytes& jpeg) const {
        const auto bytes = test::file_bytes(path_);
        return std::search(bytes.begin(), bytes.end(), jpeg.begin(), jpeg.end()) != bytes.end();
    }

    const test::TemporaryFolder folder_;
    const std::string path_ = folder_.file("r.mkv");
    FakeVideoSystem system_;
    std::vector<Bytes> jpegs_;
    std::unique_ptr<FrameSource> source_;
};

TEST_F(JpegRecordingTest, KeepsTheJpegsAndShowsTheSameFramesTwice) {
    open();
    const auto live = record(2 * pictures);
    for (const Bytes& jpeg : jpegs_) {
        EXPECT_TRUE(file_holds(jpeg));
    }
    for (int round = 0; round < 2; ++round) {
        const Replay played = test::replay(path_);
        EXPECT_EQ(played.error, "");
        EXPECT_EQ(played.frames, live);
        EXPECT_EQ(played.info.frame_count, live.size());
        EXPECT_EQ(played.info.rate, 30);
    }
}

TEST_F(JpegRecordingTest, KnowsHowTheEyesLie) {
    for (const char* options : {"&first=right", "&layout=top-bottom", "&layout=top-bottom&first=right"}) {
        SCOPED_TRACE(options);
        open(options);
        const auto live = record(pictures);
        const Replay played = test::replay(path_);
        EXPECT_EQ(played.frames, live);
        EXPECT_EQ(played.info.eye_width, source_->info().eye_width);
        EXPECT_EQ(played.info.height, source_->info().height);
        source_.reset();
        std::filesystem::remove(path_);
    }
}

TEST_F(JpegRecordingTest, ADamagedJpegIsAsLostAsItWasLive) {
    open();
    for_frames(1, [](const RawFrame&) {});
    system_.fault({false, 700, 0});
    system_.fault({false, 900, 0});
    const auto live = record(3);
    EXPECT_EQ(live[0].dropped_before, 2U);
    EXPECT_EQ(test::replay(path_).frames, live);
}

TEST_F(JpegRecordingTest, TheRecorderCopiesTheJpegsToo) {
    open();
    std::vector<SeenFrame> live;
    Recorder recorder(path_, source_->info());
    for_frames(pictures, [&](const RawFrame& frame) {
        live.push_back(seen(frame));
        EXPECT_TRUE(recorder.offer(frame));
    });
    EXPECT_EQ(recorder.finish().frames, pictures);
    EXPECT_EQ(test::replay(path_).frames, live);
    RawFrame without;
    for_frames(1, [&](const RawFrame& frame) { without = frame; });
    without.jpeg = {};
    Recorder strict(folder_.file("s.mkv"), source_->info());
    EXPECT_FALSE(strict.offer(without)) << "a recording of JPEGs has nothing else";
}

TEST_F(JpegRecordingTest, AFlippedBitLeavesOneFrameOut) {
    open();
    const auto live = record(pictures);
    const auto whole = test::file_bytes(path_);
    const auto at = std::search(whole.begin(), whole.end(), jpegs_[2].begin(), jpegs_[2].end());
    ASSERT_NE(at, whole.end());
    for (std::size_t bit = 0; bit < 8 * jpegs_[2].size(); bit += 997) {
        auto bytes = whole;
        bytes[static_cast<std::size_t>(at - whole.begin()) + bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        test::put_file(path_, bytes.data(), bytes.size());
        const Replay played = test::replay(path_);
        EXPECT_EQ(played.error, path_ +
                                    ": damaged: 4 of 5 frames could be read, 1 frame was left out, the first because "
                                    "its JPEG is not the one that was recorded");
        ASSERT_EQ(played.frames.size(), pictures - 1);
        EXPECT_EQ(played.frames[2].sequence, live[3].sequence);
        EXPECT_EQ(played.frames[2].dropped_before, 1U);
        EXPECT_EQ(played.frames[2].pixels, live[3].pixels);
    }
}

TEST_F(JpegRecordingTest, SamplesOfAJpegThatIsRefusedCountAsLost) {
    open();
    RecordingWriter writer(path_, source_->info());
    for (std::size_t i = 0; i < 3; ++i) {
        std::vector<SensorSample> samples{test::make_sample(0), test::make_sample(1)};
        samples[0].lost_before = 3;
        samples[1].lost_before = 0;
        for_frames(1, [&](RawFrame frame) {
            frame.jpeg = frame.jpeg.first(i == 1 ? frame.jpeg.size() / 2 : frame.jpeg.size());
            frame.sensors = samples;
            writer.write(frame);
        });
    }
    writer.close();
    const Replay played = test::replay(path_);
    EXPECT_THAT(played.error, testing::HasSubstr("2 of 3 frames could be read, 1 frame was left out"));
    ASSERT_EQ(played.frames.size(), 2U);
    EXPECT_EQ(played.frames[1].dropped_before, 1U);
    ASSERT_EQ(played.frames[1].sensors.size(), 2U);
    EXPECT_EQ(played.frames[1].sensors[0].lost_before, 3U + 2 + 3);
}

TEST_F(JpegRecordingTest, DamagedTagsAreRefused) {
    open();
    record(pictures);
    const auto whole = test::file_bytes(path_);
    const auto refusal_with = [&](std::string_view tag, std::string_view value) {
        auto bytes = whole;
        const auto key = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end());
        // The name of the tag, the head of the value's element, the value.
        std::copy(value.begin(), value.end(), key + static_cast<std::ptrdiff_t>(tag.size()) + 3);
        test::put_file(path_, bytes.data(), bytes.size());
        return test::refusal(path_);
    };
    EXPECT_EQ(refusal_with("DISPARITYD_LAYOUT", "side-by-hand"),
              path_ + ": the recording is damaged: its tag DISPARITYD_LAYOUT says \"side-by-hand\"");
    EXPECT_EQ(refusal_with("DISPARITYD_FIRST", "loft"),
              path_ + ": the recording is damaged: its tag DISPARITYD_FIRST says \"loft\"");
    EXPECT_EQ(refusal_with("DISPARITYD_LAYOUT", "top-bottom  "),
              path_ + ": the recording is damaged: its tag DISPARITYD_LAYOUT says \"top-bottom  \"");
    EXPECT_EQ(refusal_with("DISPARITYD_FORMAT", "1"),
              path_ + ": the recording is damaged: its tag DISPARITYD_PIXELS says \"yuyv\"")
        << "the pixels are not packed as format 1 packs them";
    EXPECT_EQ(refusal_with("DISPARITYD_FORMAT", "3"),
              path_ + ": is a recording of format 3, this program reads the formats 1 and 2");
}

}  // namespace
}  // namespace disparityd::capture
