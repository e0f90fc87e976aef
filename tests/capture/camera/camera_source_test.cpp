// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_source.h"

#include <cerrno>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "capture/camera/eye_joiner.h"
#include "tests/capture/camera/camera_fixture.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Next = FrameSource::Next;
using test::FakeVideoSystem;
using test::zed2;

class CameraSourceTest : public test::FakeCameraTest {
protected:
    FakeVideoSystem::Camera& camera() { return system_.camera("/dev/video0"); }

    void open(const std::string& uri = "v4l2:64x16@30", SourceOptions options = {}) {
        options.uri = uri;
        options.loans = 4;
        options.wait_for_camera = true;
        options.report = [this](const std::string& line, bool) { reports_.push_back(line); };
        source_ = open_camera_on(system_, options);
    }

    /// Runs for this long as the capture stage does, giving every frame back; how many came.
    int run(std::chrono::milliseconds time) {
        int frames = 0;
        for (const auto until = system_.now() + time; system_.now() < until;) {
            RawFrame frame;
            if (source_->next(frame, std::min(until, system_.now() + 100ms)) == Next::frame) {
                ++frames;
                last_ = frame;
                source_->give_back(frame);
            }
        }
        return frames;
    }

    /// Until a frame comes, at most this long; how long it took.
    std::chrono::milliseconds time_to_frame(std::chrono::milliseconds most) {
        const auto start = system_.now();
        while (system_.now() < start + most) {
            if (run(10ms) > 0) {
                break;
            }
        }
        return std::chrono::duration_cast<std::chrono::milliseconds>(system_.now() - start);
    }

    CameraState state() const { return source_->condition().camera->state; }
};

TEST_F(CameraSourceTest, DeliversFramesWithTimesAndCountsWhatIsLost) {
    system_.plug(zed2());
    open();
    EXPECT_TRUE(source_->info().live);
    EXPECT_EQ(source_->info().eye_width, 32);
    RawFrame first;
    ASSERT_EQ(source_->next(first, system_.now() + 1s), Next::timeout) << "opening is a step of its own";
    ASSERT_EQ(source_->next(first, system_.now() + 1s), Next::frame);
    EXPECT_EQ(first.sequence, 0U);
    EXPECT_EQ(first.flags, frame_flag_none);
    EXPECT_EQ(first.realtime_ns - first.monotonic_ns, 1'700'000'000'000'000'000);
    EXPECT_EQ(first.image.stride, 128);
    system_.fault({false, 64 * 16 * 2, 3});
    RawFrame second;
    ASSERT_EQ(source_->next(second, system_.now() + 1s), Next::frame);
    EXPECT_EQ(second.sequence, 4U);
    EXPECT_EQ(second.dropped_before, 3U);
    EXPECT_EQ(second.image.data[5], 4);
    source_->give_back(first);
    source_->give_back(second);
    EXPECT_EQ(state(), CameraState::streaming);
    EXPECT_EQ(facts().model, "ZED 2");
    EXPECT_EQ(facts().firmware, "1.42");
    EXPECT_TRUE(source_->condition().delivering);
}

TEST_F(CameraSourceTest, WaitsForACameraThatIsNotThere) {
    open("v4l2:64x16@30?serial=12345");
    EXPECT_EQ(run(5s), 0);
    EXPECT_EQ(state(), CameraState::absent);
    EXPECT_FALSE(source_->condition().delivering);
    EXPECT_THAT(detail(), HasSubstr("no camera with serial 12345: plug it in"));
    EXPECT_THAT(reports_, ElementsAre(HasSubstr("plug it in")));
    EXPECT_LT(system_.waits(), 200) << "no busy wait";
    system_.plug(zed2("/dev/video3"));
    EXPECT_LT(time_to_frame(5s), 500ms);
    EXPECT_EQ(state(), CameraState::streaming);
    EXPECT_EQ(facts().node, "/dev/video3");
}

TEST_F(CameraSourceTest, WithoutWaitingAnAbsentCameraIsARefusal) {
    SourceOptions options;
    options.uri = "v4l2:hd720";
    EXPECT_THROW(open_camera_on(system_, options), std::runtime_error);
}

TEST_F(CameraSourceTest, UnplugAndReplugUnderAnotherNode) {
    system_.plug(zed2());
    open();
    EXPECT_GT(run(1s), 20);
    const auto before = last_.sequence;
    system_.unplug("/dev/video0");
    EXPECT_EQ(run(1s), 0);
    EXPECT_EQ(state(), CameraState::absent);
    EXPECT_THAT(detail(), HasSubstr("was unplugged"));
    EXPECT_EQ(reported("plug it in"), 1);
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_EQ(system_.mapped(), 0);
    auto again = zed2("/dev/video2");
    again.usb.address = 9;
    system_.plug(again);
    EXPECT_LT(time_to_frame(5s), 500ms);
    EXPECT_EQ(last_.flags, frame_flag_discontinuity);
    EXPECT_EQ(last_.sequence, before + 1);
    EXPECT_EQ(facts().arrivals, 2U);
    EXPECT_EQ(facts().restarts + facts().reopens + facts().resets, 0U);
}

TEST_F(CameraSourceTest, FiftyPluggingsLeakNothing) {
    system_.plug(zed2());
    open();
    for (int i = 0; i < 50; ++i) {
        ASSERT_LT(time_to_frame(5s), 500ms) << i;
        RawFrame held;
        ASSERT_EQ(source_->next(held, system_.now() + 1s), Next::frame);
        system_.unplug("/dev/video0");
        run(300ms);
        EXPECT_EQ(system_.mapped(), 1) << "the frame that is held";
        source_->give_back(held);
        run(10ms);
        EXPECT_EQ(system_.mapped(), 0);
        EXPECT_EQ(system_.open_devices(), 0);
        system_.plug(zed2());
    }
}

struct Stall {
    int heal_by;
    std::vector<std::string> reports;
};

// What ctest lists; found by GoogleTest.
void PrintTo(const Stall& stall, std::ostream* out) {
    *out << "healed by: " << stall.reports.back();
}

class CameraStallTest : public CameraSourceTest, public ::testing::WithParamInterface<Stall> {};

TEST_P(CameraStallTest, GetsTheHelpThatItNeedsAndNoMore) {
    system_.plug(zed2());
    open();
    run(5s);
    reports_.clear();
    camera().frozen = true;
    camera().heal_by = GetParam().heal_by;
    EXPECT_LT(time_to_frame(20s), 8s);
    run(3s);
    EXPECT_EQ(state(), CameraState::streaming);
    ASSERT_EQ(reports_.size(), GetParam().reports.size() + 1);
    for (std::size_t i = 0; i < GetParam().reports.size(); ++i) {
        EXPECT_THAT(reports_[i], HasSubstr(GetParam().reports[i]));
    }
    EXPECT_THAT(reports_.back(), HasSubstr("frames come from ZED 2"));
    const std::uint64_t steps = GetParam().reports.size();
    EXPECT_EQ(facts().restarts, 1U);
    EXPECT_EQ(facts().reopens, steps > 1 ? 1U : 0U);
    EXPECT_EQ(facts().resets, steps > 2 ? 1U : 0U);
    EXPECT_EQ(system_.count("reset 2:5"), steps > 2 ? 1 : 0);
}

INSTANTIATE_TEST_SUITE_P(Ladder, CameraStallTest,
                         ::testing::Values(Stall{1, {"the stream is restarted"}},
                                           Stall{2, {"the stream is restarted", "opened anew"}},
                                           Stall{3, {"the stream is restarted", "opened anew", "reset on the USB"}}));

TEST_F(CameraSourceTest, AFrozenCameraThatThawsByItselfIsBackAtOnce) {
    system_.plug(zed2());
    open();
    run(5s);
    camera().frozen = true;
    run(30s);
    EXPECT_EQ(state(), CameraState::stalled);
    EXPECT_THAT(detail(), HasSubstr("has stopped sending frames"));
    camera().frozen = false;
    EXPECT_LT(time_to_frame(10s), 2s);
    EXPECT_EQ(state(), CameraState::streaming);
}

TEST_F(CameraSourceTest, ACallerThatIsAwayForLongIsNoSilence) {
    system_.plug(zed2());
    open();
    run(5s);
    for (int i = 0; i < 5; ++i) {
        system_.advance(1500ms);
        RawFrame frame;
        ASSERT_EQ(source_->next(frame, system_.now()), Next::frame) << i;
        source_->give_back(frame);
    }
    EXPECT_EQ(facts().restarts, 0U);
    EXPECT_EQ(reported("the stream is restarted"), 0);
    camera().frozen = true;
    run(10s);
    EXPECT_GT(facts().restarts, 0U) << "a camera that sends nothing is helped all the same";
}

TEST_F(CameraSourceTest, DeadTransfersAreStartedAnew) {
    system_.plug(zed2());
    open();
    run(5s);
    system_.hand_back_all();
    camera().dead = true;
    EXPECT_LT(time_to_frame(10s), 2s);
    EXPECT_EQ(facts().restarts, 1U);
    EXPECT_EQ(facts().reopens, 0U);
}

TEST_F(CameraSourceTest, AnErrorOfTheStreamIsHelpedAtOnce) {
    system_.plug(zed2());
    open();
    run(5s);
    camera().dequeue_error = EIO;
    EXPECT_LT(time_to_frame(10s), 200ms);
    EXPECT_EQ(facts().restarts, 1U);
}

TEST_F(CameraSourceTest, AResetThatIsNotAllowedSaysWhatToDo) {
    system_.plug(zed2());
    system_.reset_error = EACCES;
    open();
    camera().frozen = true;
    run(20s);
    EXPECT_EQ(reported("failed: Permission denied; install disparityd's udev rule"), facts().resets);
    EXPECT_GE(facts().resets, 1U);
}

struct Refusal {
    std::function<void(FakeVideoSystem::Camera&)> cause;
    std::function<void(FakeVideoSystem::Camera&)> cure;
    CameraState state;
    std::string says;
};

// What ctest lists; found by GoogleTest.
void PrintTo(const Refusal& refusal, std::ostream* out) {
    *out << to_string(refusal.state);
}

class CameraRefusalTest : public CameraSourceTest, public ::testing::WithParamInterface<Refusal> {};

TEST_P(CameraRefusalTest, IsNamedOnceAndOvercomeByItself) {
    GetParam().cause(system_.plug(zed2()));
    open("v4l2:hd720@30");
    camera().width = 2560;
    camera().height = 720;
    GetParam().cause(camera());
    EXPECT_EQ(run(4s), 0);
    EXPECT_EQ(state(), GetParam().state);
    EXPECT_THAT(detail(), HasSubstr(GetParam().says));
    EXPECT_EQ(reported(GetParam().says), 1);
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_EQ(system_.mapped(), 0);
    GetParam().cure(camera());
    EXPECT_LT(time_to_frame(5s), 500ms);
    EXPECT_EQ(state(), CameraState::streaming);
}

using Camera = FakeVideoSystem::Camera;

INSTANTIATE_TEST_SUITE_P(
    Reasons, CameraRefusalTest,
    ::testing::Values(Refusal{[](Camera& c) { c.buffers_error = EBUSY; }, [](Camera& c) { c.buffers_error = 0; },
                              CameraState::busy,
                              "is in use by another program: end that (fuser -v /dev/video0 names it)"},
                      Refusal{[](Camera& c) { c.open_error = EACCES; }, [](Camera& c) { c.open_error = 0; },
                              CameraState::no_permission, "add the user to the group video"},
                      Refusal{[](Camera& c) { c.usb.product = 0xf580; }, [](Camera& c) { c.usb.product = 0xf582; },
                              CameraState::old_firmware, "old firmware (USB id 2b03:f580)"},
                      Refusal{[](Camera& c) { c.usb.speed_mbit = 480; }, [](Camera& c) { c.usb.speed_mbit = 5000; },
                              CameraState::usb2_link, "is on a USB 2 link (480 Mbit/s), which has no hd720"},
                      Refusal{[](Camera& c) { c.width = 1344; }, [](Camera& c) { c.width = 2560; },
                              CameraState::mode_refused, "does not offer 2560x720 YUYV, nearest is 1344x720 YUYV"},
                      Refusal{[](Camera& c) { c.start_error = ENOSPC; }, [](Camera& c) { c.start_error = 0; },
                              CameraState::failed, "not enough bandwidth"}));

TEST_F(CameraSourceTest, UdevGetsAMomentToGiveLeave) {
    system_.plug(zed2()).open_error = EACCES;
    open();
    run(600ms);
    EXPECT_EQ(state(), CameraState::starting);
    camera().open_error = 0;
    EXPECT_LT(time_to_frame(5s), 500ms);
    EXPECT_EQ(reported("group video"), 0);
}

TEST_F(CameraSourceTest, WhatKeepsAZedComesBeforeWhatKeepsAnotherCamera) {
    auto webcam = zed2("/dev/video0", "");
    webcam.usb.vendor = 0x046d;
    webcam.usb.name = "webcam";
    webcam.usb.port = "1-1";
    webcam.usb.address = 9;
    webcam.open_error = EACCES;
    system_.plug(webcam);
    auto zed = zed2("/dev/video2");
    zed.open_error = EACCES;
    system_.plug(zed);
    open();
    run(600ms);
    EXPECT_EQ(state(), CameraState::starting);
    run(2s);
    EXPECT_EQ(state(), CameraState::no_permission) << "each camera's time runs from its own plugging";
    EXPECT_THAT(detail(), HasSubstr("ZED 2"));
    system_.unplug("/dev/video2");
    zed.usb.product = 0xf580;
    system_.plug(zed);
    run(3s);
    EXPECT_EQ(state(), CameraState::old_firmware);
}

TEST_F(CameraSourceTest, AmongSeveralTheOneThatIsMeant) {
    auto other = zed2("/dev/video0", "111");
    other.usb.port = "1-1";
    system_.plug(other);
    auto meant = zed2("/dev/video2", "222");
    meant.usb.port = "1-2";
    system_.plug(meant);
    for (const char* uri : {"v4l2:64x16?serial=222", "v4l2:64x16?device=/dev/video2", "v4l2:64x16?port=1-2"}) {
        open(uri);
        EXPECT_GT(run(1s), 0) << uri;
        EXPECT_EQ(facts().serial, "222") << uri;
    }
    open("v4l2:64x16?serial=333");
    EXPECT_EQ(run(1s), 0);
    EXPECT_THAT(detail(), HasSubstr("(there: ZED 2 (serial 111, /dev/video0"));
}

TEST_F(CameraSourceTest, ABusyCameraGivesWayToOneThatWorks) {
    system_.plug(zed2("/dev/video0", "111")).buffers_error = EBUSY;
    system_.plug(zed2("/dev/video2", "222"));
    open();
    EXPECT_GT(run(1s), 0);
    EXPECT_EQ(facts().serial, "222");
}

TEST_F(CameraSourceTest, EyesOneAboveTheOtherComeSideBySide) {
    system_.plug(zed2());
    open("v4l2:64x16@30?layout=top-bottom");
    EXPECT_EQ(source_->info().eye_width, 64);
    EXPECT_EQ(source_->info().height, 8);
    EXPECT_GT(run(2s), 40) << "buffers go back to the driver";
    EXPECT_EQ(last_.image.stride, 256);
}

TEST_F(CameraSourceTest, InterleavedEyesComeSideBySideWhateverTheDriverCallsThem) {
    auto camera = zed2();
    camera.format = V4L2_PIX_FMT_Y16;
    system_.plug(camera);
    open("v4l2:64x16@30?format=y8i&force=Y16");
    EXPECT_EQ(source_->info().eye_width, 64);
    EXPECT_EQ(source_->info().height, 16);
    EXPECT_EQ(source_->info().format, PixelFormat::grey8);
    EXPECT_GT(run(2s), 40) << "buffers go back to the driver";
    EXPECT_EQ(last_.image.stride, 128);
}

TEST_F(CameraSourceTest, AFormatThatTheDriverCallsOtherwiseIsRefusedUnlessForced) {
    auto camera = zed2();
    camera.format = V4L2_PIX_FMT_Y16;
    system_.plug(camera);
    open("v4l2:64x16@30?format=y8i");
    EXPECT_EQ(run(2s), 0);
    EXPECT_THAT(detail(), HasSubstr("does not offer 64x16 Y8I"));
}

TEST(EyeJoinerTest, TakesInterleavedEyesApart) {
    const std::uint8_t sent[] = {10, 20, 11, 21, 0, 0, 12, 22, 13, 23, 0, 0};  // rows with a gap
    for (const bool right_first : {false, true}) {
        EyeJoiner joiner({2, 2, false, right_first, true}, *camera_format_of_name("y8i"), 1);
        const int index = joiner.join(sent, 6);
        const std::vector<std::uint8_t> joined(joiner.data(index), joiner.data(index) + 8);
        if (right_first) {
            EXPECT_THAT(joined, ElementsAre(20, 21, 10, 11, 22, 23, 12, 13));
        } else {
            EXPECT_THAT(joined, ElementsAre(10, 11, 20, 21, 12, 13, 22, 23));
        }
    }
}

TEST(EyeJoinerTest, PutsTheLeftEyeFirst) {
    // Two rows of two bytes for each eye, of which the right one is sent first.
    const std::uint8_t side_by_side[] = {20, 21, 10, 11, 22, 23, 12, 13};
    const std::uint8_t top_bottom[] = {20, 21, 22, 23, 10, 11, 12, 13};
    for (const bool above : {false, true}) {
        EyeJoiner joiner({2, 2, above, true}, *camera_format_of_name("grey"), 1);
        const int index = joiner.join(above ? top_bottom : side_by_side, above ? 2 : 4);
        const std::vector<std::uint8_t> joined(joiner.data(index), joiner.data(index) + 8);
        EXPECT_THAT(joined, ElementsAre(10, 11, 20, 21, 12, 13, 22, 23));
        EXPECT_FALSE(joiner.has_room());
    }
}

TEST_F(CameraSourceTest, TheSerialNumberIsTheOneInTheCamera) {
    system_.plug(zed2("/dev/video0", "OV0001")).flash_serial = "10028000";
    system_.plug(zed2("/dev/video2", "OV0001")).flash_serial = "4711";
    open("v4l2:64x16?serial=4711");
    EXPECT_GT(run(1s), 0);
    EXPECT_EQ(facts().node, "/dev/video2");
    EXPECT_EQ(facts().serial, "4711");
}

TEST_F(CameraSourceTest, ACameraThatMayNotBeAskedForItsNumberSaysSo) {
    system_.plug(zed2("/dev/video0", "OV0001")).open_error = EACCES;
    open("v4l2:64x16?serial=4711");
    run(3s);
    EXPECT_EQ(state(), CameraState::no_permission);
    EXPECT_THAT(detail(), HasSubstr("group video"));
}

TEST_F(CameraSourceTest, StopsInEveryState) {
    const auto interrupted = [this] {
        source_->interrupt();
        RawFrame frame;
        const auto before = system_.now();
        EXPECT_EQ(source_->next(frame, before + 1h), Next::interrupted);
        EXPECT_EQ(source_->next(frame, before + 1h), Next::interrupted);
        EXPECT_EQ(system_.now(), before);
        EXPECT_EQ(system_.open_devices(), 0);
    };
    open();
    interrupted();
    open();
    run(1s);
    interrupted();
    system_.plug(zed2());
    open();
    run(1s);
    interrupted();
    open();
    camera().frozen = true;
    run(4s);
    interrupted();
    open();
    camera().buffers_error = EBUSY;
    run(1s);
    interrupted();
}

TEST_F(CameraSourceTest, InterruptWakesASleepingThread) {
    SourceOptions options;
    options.uri = "v4l2:64x16?device=/dev/there-is-none";
    options.wait_for_camera = true;
    const auto source = open_camera(options);
    std::thread other([&source] { source->interrupt(); });
    RawFrame frame;
    Next got = Next::timeout;
    while (got == Next::timeout) {
        got = source->next(frame, std::chrono::steady_clock::now() + 1h);
    }
    EXPECT_EQ(got, Next::interrupted);
    other.join();
}

}  // namespace
}  // namespace disparityd::capture
