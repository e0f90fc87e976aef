// SPDX-License-Identifier: Apache-2.0
//
// Two cameras that are the eyes of one source.
#include <cerrno>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <turbojpeg.h>

#include "capture/camera/camera_source.h"
#include "capture/camera_setting.h"
#include "capture/recording/recording_writer.h"
#include "capture/source_condition.h"
#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/camera/made_jpeg.h"
#include "tests/capture/camera/pair_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Next = FrameSource::Next;
using test::Bytes;
using test::CameraPairTest;
using test::left_node;
using test::pair_uri;
using test::right_node;

/// A picture whose bytes tell frame, row and column; `from` is the first of its columns in the whole.
auto pattern(std::size_t width, std::size_t from) {
    return [=](std::uint32_t sequence, Bytes& picture) {
        for (std::size_t i = 0; i < picture.size(); ++i) {
            const std::size_t column = from + i % width;
            picture[i] = static_cast<std::uint8_t>(sequence * 89 + i / width * 31 + column * column);
        }
    };
}

TEST_F(CameraPairTest, PairsByTheDriversStampsWhateverTheExposuresAre) {
    left().exposure = 160;  // half of it is 8 ms, and the right camera tells none
    SourceOptions options;
    options.stamp = Stamp::exposure_centre;
    open(std::string(pair_uri) + "&within_ms=2", options);
    EXPECT_GT(run(4s), 90);
    EXPECT_EQ(last_.flags & frame_flag_exposure_centre, frame_flag_exposure_centre);
    EXPECT_EQ(reported("not synchronised"), 0);
}

TEST_F(CameraPairTest, HasTheBytesOfOneCameraWithBothEyes) {
    for (const std::uint32_t format : {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_GREY}) {
        const bool grey = format == V4L2_PIX_FMT_GREY;
        const std::size_t row = grey ? 64 : 128;
        auto both = left();
        both.usb.node = "/dev/video4";
        both.width = 128;
        both.draw = pattern(2 * row, 0);
        left().draw = pattern(row, 0);
        right().draw = pattern(row, row);
        both.format = left().format = right().format = format;
        system_.plug(both);
        std::vector<test::SeenFrame> frames[2];
        SourceInfo infos[2];
        const std::string option = grey ? "&format=grey" : "";
        const std::string uris[] = {pair_uri + option, "v4l2:128x16@30?device=/dev/video4" + option};
        for (std::size_t i = 0; i < 2; ++i) {
            open(uris[i]);
            infos[i] = source_->info();
            for (int n = 0; n < 20; ++n) {
                RawFrame frame;
                ASSERT_TRUE(next(frame));
                frames[i].push_back(test::seen(frame));
                source_->give_back(frame);
            }
        }
        EXPECT_EQ(infos[0].eye_width, 64);
        EXPECT_EQ(infos[0].eye_width, infos[1].eye_width);
        EXPECT_EQ(infos[0].height, infos[1].height);
        EXPECT_EQ(infos[0].format, infos[1].format);
        for (std::size_t n = 0; n < frames[0].size(); ++n) {
            EXPECT_EQ(frames[0][n].pixels, frames[1][n].pixels) << n;
            EXPECT_EQ(frames[0][n].sequence, n);
        }
    }
}

TEST_F(CameraPairTest, JpegsOfEachCameraAreDecoded) {
    constexpr int width = 64;
    constexpr int height = 16;
    Bytes eyes[2];
    for (unsigned eye = 0; eye < 2; ++eye) {
        auto& camera = eye == 0 ? left() : right();
        camera.format = V4L2_PIX_FMT_MJPEG;
        camera.jpegs = {test::made_jpeg(width, height, TJSAMP_422, eye)};
        eyes[eye] = test::yuyv_of(test::planes_of(camera.jpegs[0], width, height), width, height);
    }
    for (const int decoders : {0, 2}) {
        SourceOptions options;
        options.uri = std::string(pair_uri) + "&format=mjpeg";
        options.decoders = decoders;
        source_ = open_camera_on(system_, options);
        RawFrame frame;
        // With threads, the clock of the test may be ahead of them.
        for (int i = 0; i < 1000 && source_->next(frame, system_.now() + 1s) != Next::frame; ++i) {
            std::this_thread::yield();
        }
        ASSERT_NE(frame.image.data, nullptr);
        EXPECT_TRUE(frame.jpeg.empty());
        for (int y = 0; y < height; ++y) {
            for (const Eye eye : {Eye::left, Eye::right}) {
                const Bytes& expected = eyes[static_cast<std::size_t>(eye)];
                EXPECT_TRUE(std::equal(expected.begin() + 2 * width * y, expected.begin() + 2 * width * (y + 1),
                                       frame.image.eye(eye).row(y)))
                    << y;
            }
        }
        source_->give_back(frame);
        source_.reset();
    }
}

TEST_F(CameraPairTest, AFrameWithoutPartnerIsCountedAndItsPairLost) {
    open();
    RawFrame frame;
    ASSERT_TRUE(next(frame));
    EXPECT_EQ(frame.sequence, 0U);
    EXPECT_EQ(frame.dropped_before, 0U);
    EXPECT_EQ(frame.flags, frame_flag_none);
    EXPECT_EQ(frame.realtime_ns - frame.monotonic_ns, 1'700'000'000'000'000'000);
    source_->give_back(frame);
    const std::uint64_t unpaired = facts().unpaired;
    system_.fault({false, 0, 0, right_node});  // too short
    ASSERT_TRUE(next(frame));
    EXPECT_EQ(frame.dropped_before, 1U);
    EXPECT_EQ(frame.sequence, 2U);
    EXPECT_EQ(facts().unpaired, unpaired + 1);
    EXPECT_EQ(facts().too_short, 1U);
    source_->give_back(frame);
    EXPECT_GT(run(1s), 25);
    EXPECT_EQ(facts().unpaired, unpaired + 1);
    EXPECT_EQ(last_.dropped_before, 0U);
}

TEST_F(CameraPairTest, NumbersThatADriverLeavesOutArePairsThatAreLost) {
    open();
    RawFrame frame;
    ASSERT_TRUE(next(frame));
    source_->give_back(frame);
    system_.fault({false, 64 * 16 * 2, 3, left_node});
    ASSERT_TRUE(next(frame));
    EXPECT_EQ(frame.dropped_before, 3U);
    EXPECT_EQ(frame.sequence, 4U);
    source_->give_back(frame);
}

TEST_F(CameraPairTest, AnEyeThatIsUnpluggedAndComesBackIsOpenedAnewAlone) {
    open("v4l2:64x16@30?left=port:1-1&right=port:1-2");
    EXPECT_GT(run(2s), 50);
    const auto before = last_.sequence;
    system_.unplug(right_node);
    EXPECT_LE(run(3s), 1);
    EXPECT_EQ(facts().state, CameraState::absent);
    EXPECT_THAT(detail(), AllOf(HasSubstr("/dev/video2"), HasSubstr("was unplugged"), Not(HasSubstr("/dev/video0"))));
    EXPECT_FALSE(source_->condition().delivering);
    plug("/dev/video5", "1-2", "B2").usb.address = 99;
    RawFrame frame;
    ASSERT_TRUE(next(frame, 600ms));
    EXPECT_EQ(frame.flags, frame_flag_discontinuity);
    EXPECT_NEAR(static_cast<double>(frame.dropped_before), 3 * 30, 20) << "frames of the left eye alone";
    EXPECT_EQ(frame.sequence, before + 1 + frame.dropped_before);
    source_->give_back(frame);
    EXPECT_EQ(facts().state, CameraState::streaming);
    EXPECT_EQ(facts().arrivals, 3U);
    EXPECT_EQ(facts().node, "/dev/video0,/dev/video5");
    EXPECT_EQ(facts().restarts + facts().reopens + facts().resets, 0U);
    EXPECT_GE(facts().unpaired, 60U);
    source_->interrupt();
    EXPECT_EQ(source_->next(frame, system_.now() + 1h), Next::interrupted);
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_EQ(system_.mapped(), 0);
}

TEST_F(CameraPairTest, AnEyeThatStallsGetsTheHelpThatItNeeds) {
    for (const int heal_by : {1, 2, 3}) {
        open();
        EXPECT_GT(run(3s), 80);
        auto& stalled = heal_by == 2 ? right() : left();
        stalled.frozen = true;
        stalled.heal_by = heal_by;
        EXPECT_LE(run(900ms), 2);
        RawFrame frame;
        ASSERT_TRUE(next(frame, 8s)) << heal_by;
        source_->give_back(frame);
        EXPECT_GT(run(3s), 80) << heal_by;
        EXPECT_EQ(facts().restarts, 1U);
        EXPECT_EQ(facts().reopens, heal_by > 1 ? 1U : 0U);
        EXPECT_EQ(facts().resets, heal_by > 2 ? 1U : 0U);
        EXPECT_EQ(reported("has stopped sending frames"), heal_by);
        reports_.clear();
    }
}

TEST_F(CameraPairTest, AClockThatJumpsMakesNoPairsAndSaysSo) {
    open();
    EXPECT_GT(run(2s), 50);
    right().stamp_ahead = -2s;
    EXPECT_LE(run(3s), 1);
    EXPECT_EQ(facts().state, CameraState::unpaired);
    EXPECT_THAT(detail(), AllOf(HasSubstr("no two frames are within 16.7 ms"), HasSubstr("the nearest are")));
    EXPECT_FALSE(source_->condition().delivering);
    EXPECT_FALSE(source_->condition().camera->apart) << "an old number is none";
    EXPECT_EQ(facts().restarts, 0U);
    right().stamp_ahead = 0s;
    EXPECT_GT(run(1s), 25);
    EXPECT_EQ(facts().state, CameraState::streaming);
    EXPECT_EQ(reported("pairs of frames come again"), 1);
}

TEST_F(CameraPairTest, FramesWithoutTheirDriversTimeAreNoPairs) {
    left().old_clock = true;
    open();
    EXPECT_EQ(run(3s), 0);
    EXPECT_EQ(facts().state, CameraState::unpaired);
    EXPECT_THAT(detail(), HasSubstr("a driver gives its frames no time"));
    left().old_clock = false;
    EXPECT_GT(run(1s), 25);
    EXPECT_EQ(detail(), "");
}

TEST_F(CameraPairTest, CamerasThatRunFreeAreWarnedOf) {
    left().trigger = 0us;
    right().trigger = 10'000us;
    open();
    EXPECT_GT(run(4s), 100);
    EXPECT_FALSE(facts().apart) << "unknown yet";
    EXPECT_GT(run(2s), 50);
    ASSERT_TRUE(facts().apart);
    EXPECT_EQ(facts().apart->median_ns, 10'000'000);
    EXPECT_NEAR(facts().apart->drift, 0, 1e-9);
    EXPECT_THAT(notices(), Contains(HasSubstr("not synchronised")));
    EXPECT_EQ(reported("not synchronised: their frames are 10 ms apart"), 1);
    run(10s);
    EXPECT_EQ(reported("not synchronised"), 1) << "told once";
}

TEST_F(CameraPairTest, CamerasWithACommonTriggerAreNot) {
    left().trigger = 0us;
    right().trigger = 300us;
    open();
    EXPECT_GT(run(6s), 150);
    ASSERT_TRUE(facts().apart);
    EXPECT_EQ(facts().apart->median_ns, 300'000);
    EXPECT_THAT(notices(), Not(Contains(HasSubstr("synchronised"))));
    EXPECT_EQ(reported("synchronised"), 0);
}

TEST_F(CameraPairTest, ClocksThatDriftAreToldAndTheFrameThatIsTooManyCounted) {
    right().period = 33'433us;  // 3000 ppm slower: a frame is too many after 333
    open();
    run(8s);
    ASSERT_TRUE(facts().apart);
    EXPECT_NEAR(facts().apart->drift, 0.003, 0.0001);
    const std::uint64_t unpaired = facts().unpaired;
    const int pairs = run(24s);
    EXPECT_NEAR(static_cast<double>(facts().unpaired - unpaired), 2, 1);
    EXPECT_NEAR(pairs, 24 / 0.033433, 3);
    EXPECT_NEAR(facts().apart->drift, 0.003, 0.0005) << "where partners change is no drift";
}

TEST_F(CameraPairTest, ANarrowerLimitHolds) {
    left().trigger = 0us;
    right().trigger = 5'000us;
    open(std::string(pair_uri) + "&within_ms=4.9");
    EXPECT_EQ(run(2s), 0);
    EXPECT_THAT(detail(), HasSubstr("no two frames are within 4.9 ms of each other, the nearest are 5 ms apart"));
    open(std::string(pair_uri) + "&within_ms=5");
    EXPECT_GT(run(2s), 50);
}

TEST_F(CameraPairTest, CamerasThatAreFasterThanAskedForHaveTheNearestPartner) {
    for (const bool untold : {false, true}) {
        for (auto* camera : {&left(), &right()}) {
            camera->period = 16'667us;
            camera->agreed_rate = 60;
            camera->untold_rate = untold;
            camera->trigger = camera == &left() ? 0us : 10'000us;
        }
        open();
        EXPECT_GT(run(6s), 300);
        ASSERT_TRUE(facts().apart);
        EXPECT_EQ(facts().apart->median_ns, -6'667'000) << "10 ms are farther, though within half of a 30th second";
        EXPECT_LE(facts().unpaired, 3U);
    }
}

TEST_F(CameraPairTest, ACameraWithAnotherSizeIsRefusedByName) {
    right().width = 32;
    open();
    EXPECT_EQ(run(2s), 0);
    EXPECT_EQ(facts().state, CameraState::mode_refused);
    EXPECT_THAT(detail(), HasSubstr("/dev/video2: does not offer 64x16 YUYV, nearest is 32x16 YUYV"));
    EXPECT_THAT(detail(), Not(HasSubstr("/dev/video0")));
    SourceOptions options;
    options.uri = pair_uri;
    EXPECT_THROW(open_camera_on(system_, options), std::runtime_error);
}

TEST_F(CameraPairTest, EyesMayBeSwapped) {
    for (const char* uri :
         {"v4l2:64x16@30?left=/dev/video2&right=/dev/video0", "v4l2:64x16@30?left=port:1-2&right=port:1-1",
          "v4l2:64x16@30?left=serial:B2&right=serial:A1"}) {
        left().draw = pattern(128, 0);
        right().draw = pattern(128, 128);
        open(uri);
        RawFrame frame;
        ASSERT_TRUE(next(frame)) << uri;
        Bytes picture(2048);
        pattern(128, 128)(0, picture);
        EXPECT_TRUE(std::equal(picture.begin(), picture.begin() + 128, frame.image.eye(Eye::left).row(0))) << uri;
        EXPECT_EQ(facts().serial, "B2,A1");
        source_->give_back(frame);
    }
}

TEST_F(CameraPairTest, ControlsAreSetOnBothAtEveryOpening) {
    SourceOptions options;
    options.controls = "brightness-auto=7";
    open(pair_uri, options);
    run(1s);
    EXPECT_EQ(left().brightness, 7);
    EXPECT_EQ(right().brightness, 7);
    const auto controls = source_->set_camera_controls({{"brightness-auto", 2}});
    EXPECT_EQ(controls.at(0).value, 2);
    EXPECT_EQ(left().brightness, 2);
    EXPECT_EQ(right().brightness, 2);
    system_.unplug(right_node);
    run(1s);
    EXPECT_THROW(source_->set_camera_controls({{"brightness-auto", 3}}), std::runtime_error);
    plug(right_node, "1-2", "B2");
    run(1s);
    EXPECT_EQ(right().brightness, 3) << "what was set since holds for a camera that comes back";
}

TEST_F(CameraPairTest, AllLoansOutStopNothing) {
    open();
    std::vector<RawFrame> out(4);
    for (RawFrame& frame : out) {
        ASSERT_TRUE(next(frame));
    }
    const Bytes kept(out[0].image.data, out[0].image.data + 100);
    RawFrame none;
    EXPECT_FALSE(next(none, 3s));
    EXPECT_EQ(facts().state, CameraState::streaming);
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), out[0].image.data));
    for (const RawFrame& frame : out) {
        source_->give_back(frame);
    }
    EXPECT_GT(run(1s), 20);
    EXPECT_EQ(facts().restarts, 0U);
}

TEST_F(CameraPairTest, StopsInEveryStateAndLeaksNothing) {
    const auto interrupted = [this] {
        source_->interrupt();
        RawFrame frame;
        const auto before = system_.now();
        EXPECT_EQ(source_->next(frame, before + 1h), Next::interrupted);
        EXPECT_EQ(source_->next(frame, before + 1h), Next::interrupted);
        EXPECT_EQ(system_.now(), before);
        EXPECT_EQ(system_.open_devices(), 0);
        EXPECT_EQ(system_.mapped(), 0);
    };
    open();
    interrupted();
    open();
    run(1s);
    interrupted();
    open();
    right().frozen = true;
    run(4s);
    interrupted();
    system_.unplug(left_node);
    open();
    run(1s);
    interrupted();
}

TEST_F(CameraPairTest, ARecordingHoldsThePairs) {
    const test::TemporaryFolder folder;
    const std::string path = folder.file("r.mkv");
    left().draw = pattern(128, 0);
    right().draw = pattern(128, 128);
    open();
    std::vector<test::SeenFrame> live;
    {
        RecordingWriter writer(path, source_->info());
        for (int i = 0; i < 10; ++i) {
            RawFrame frame;
            ASSERT_TRUE(next(frame));
            live.push_back(test::seen(frame));
            writer.write(frame);
            source_->give_back(frame);
        }
        writer.close();
    }
    const test::Replay played = test::replay(path);
    EXPECT_EQ(played.error, "");
    EXPECT_EQ(played.frames, live);
}

}  // namespace
}  // namespace disparityd::capture
