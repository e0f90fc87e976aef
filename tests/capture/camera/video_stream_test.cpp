// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/video_stream.h"

#include <cerrno>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "capture/camera/frame_counter.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using Got = VideoStream::Got;
using test::FakeVideoSystem;
using test::zed2;

const StreamRequest request{64, 16, 30, V4L2_PIX_FMT_YUYV, 2, 4};

class VideoStreamTest : public ::testing::Test {
protected:
    VideoStreamTest() { system_.plug(zed2()); }

    FakeVideoSystem::Camera& camera() { return system_.camera("/dev/video0"); }

    void open_and_start() {
        stream_.open("/dev/video0", request);
        stream_.start();
    }

    Got take(VideoFrame& frame, std::chrono::milliseconds patience = 200ms) {
        const auto deadline = system_.now() + patience;
        Got got = Got::woken;
        while (got == Got::woken) {
            got = stream_.take(frame, deadline);
        }
        return got;
    }

    std::int64_t now_ns() { return std::chrono::nanoseconds(system_.now().time_since_epoch()).count(); }

    void expect_refusal(VideoError::Call call, int code) {
        try {
            open_and_start();
            FAIL() << "nothing was refused";
        } catch (const VideoError& error) {
            EXPECT_EQ(error.call, call);
            EXPECT_EQ(error.code, code);
            EXPECT_THAT(error.what(), ::testing::StartsWith("/dev/video0: "));
        }
        stream_.close();
        EXPECT_EQ(system_.open_devices(), 0);
        EXPECT_EQ(system_.mapped(), 0);
    }

    FakeVideoSystem system_;
    base::Waker waker_;
    VideoStream stream_{system_, waker_};
};

TEST_F(VideoStreamTest, LendsTheDriversMemoryAndTakesItBack) {
    open_and_start();
    for (std::uint32_t i = 0; i < 40; ++i) {
        VideoFrame frame;
        ASSERT_EQ(take(frame), Got::frame) << i;
        EXPECT_EQ(frame.sequence, i);
        EXPECT_EQ(frame.stride, 128);
        EXPECT_EQ(frame.data[0], i);
        EXPECT_EQ(frame.data[128 * 16 - 1], i);
        EXPECT_EQ(frame.monotonic_ns / 1000, std::chrono::nanoseconds(system_.now().time_since_epoch()).count() / 1000);
        stream_.give_back(frame.loan);
    }
}

TEST_F(VideoStreamTest, LendsNoMoreThanAllowedAndGoesOnWhenOneComesBack) {
    open_and_start();
    VideoFrame frames[5];
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(take(frames[i]), Got::frame);
    }
    EXPECT_EQ(take(frames[4]), Got::nothing);
    stream_.give_back(frames[2].loan);
    EXPECT_EQ(take(frames[4], 0ms), Got::frame);
    EXPECT_NE(frames[4].loan, frames[2].loan) << "the driver had older buffers";
}

TEST_F(VideoStreamTest, AReturnWakesWhoWaitsForOne) {
    open_and_start();
    VideoFrame frame;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(take(frame), Got::frame);
    }
    EXPECT_EQ(take(frame), Got::nothing);
    stream_.give_back(frame.loan);
    EXPECT_TRUE(system_.wait(-1, waker_, system_.now()).woken);
}

TEST_F(VideoStreamTest, DropsFlaggedAndShortFramesAndCountsThem) {
    open_and_start();
    system_.fault({true, 64 * 16 * 2, 0});
    system_.fault({false, 100, 0});
    VideoFrame frame;
    ASSERT_EQ(take(frame), Got::frame);
    EXPECT_EQ(frame.sequence, 2U);
    EXPECT_EQ(stream_.damaged(), 1U);
    EXPECT_EQ(stream_.too_short(), 1U);
}

TEST_F(VideoStreamTest, OutlivesAStallThatHandsAllBuffersBack) {
    open_and_start();
    VideoFrame frame;
    ASSERT_EQ(take(frame), Got::frame);
    stream_.give_back(frame.loan);
    EXPECT_EQ(take(frame, 1ms), Got::nothing);
    system_.hand_back_all();
    ASSERT_EQ(take(frame), Got::frame);
    EXPECT_EQ(stream_.damaged(), 8U);
    EXPECT_EQ(frame.sequence, 1U);
}

TEST_F(VideoStreamTest, ACameraThatFlagsEverythingDoesNotHoldTheCaller) {
    open_and_start();
    camera().flag_stays = true;
    VideoFrame frame;
    EXPECT_EQ(take(frame, 1000ms), Got::nothing);
    EXPECT_GT(stream_.damaged(), 20U);
    EXPECT_LT(system_.waits(), 100);
}

TEST_F(VideoStreamTest, UnplugIsAFailureAndLentMemoryStays) {
    open_and_start();
    VideoFrame frame;
    ASSERT_EQ(take(frame), Got::frame);
    system_.unplug("/dev/video0");
    VideoFrame next;
    EXPECT_EQ(take(next), Got::failed);
    EXPECT_EQ(stream_.failure(), EINVAL);
    stream_.close();
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_EQ(system_.mapped(), 1);
    EXPECT_EQ(frame.data[0], 0) << "still readable";
    stream_.give_back(frame.loan);
    EXPECT_TRUE(system_.wait(-1, waker_, system_.now()).woken) << "so that the memory is freed soon";
    stream_.collect();
    EXPECT_EQ(system_.mapped(), 0);
}

TEST_F(VideoStreamTest, ALoanOfAnEarlierOpeningIsNotTakenForOneOfThis) {
    open_and_start();
    VideoFrame old;
    ASSERT_EQ(take(old), Got::frame);
    stream_.close();
    open_and_start();
    VideoFrame frame;
    ASSERT_EQ(take(frame), Got::frame);
    stream_.give_back(old.loan);
    VideoFrame more;
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(take(more), Got::frame);
        EXPECT_NE(more.data, frame.data) << "a buffer was lent twice";
    }
    EXPECT_EQ(take(more), Got::nothing) << "the old loan made room for a fifth";
}

TEST_F(VideoStreamTest, RestartsWithBuffersOut) {
    open_and_start();
    VideoFrame held;
    ASSERT_EQ(take(held), Got::frame);
    stream_.stop();
    stream_.start();
    VideoFrame frame;
    for (std::uint32_t i = 0; i < 20; ++i) {
        ASSERT_EQ(take(frame), Got::frame);
        EXPECT_EQ(frame.sequence, i);
        EXPECT_NE(frame.data, held.data);
        stream_.give_back(frame.loan);
    }
    stream_.give_back(held.loan);
    ASSERT_EQ(take(frame), Got::frame);
}

TEST_F(VideoStreamTest, RefusalsNameTheCall) {
    camera().open_error = EACCES;
    expect_refusal(VideoError::Call::open, EACCES);
    camera().open_error = 0;
    camera().buffers_error = EBUSY;
    expect_refusal(VideoError::Call::buffers, EBUSY);
    camera().buffers_error = 0;
    camera().buffers_most = 2;
    expect_refusal(VideoError::Call::buffers, ENOMEM);
    camera().buffers_most = 32;
    camera().queue_error = EIO;
    expect_refusal(VideoError::Call::stream, EIO);
    camera().queue_error = 0;
    camera().start_error = ENOSPC;
    expect_refusal(VideoError::Call::stream, ENOSPC);
    camera().start_error = 0;
    camera().width = 32;
    expect_refusal(VideoError::Call::format, 0);
}

TEST_F(VideoStreamTest, AFrameThatLayInTheDriverNeverLooksFresh) {
    for (const bool old_clock : {false, true}) {
        camera().old_clock = old_clock;
        open_and_start();
        VideoFrame frame;
        ASSERT_EQ(take(frame), Got::frame);
        stream_.give_back(frame.loan);
        EXPECT_EQ(take(frame, 1ms), Got::nothing);
        const std::int64_t stopped = now_ns();
        system_.advance(12s);  // as a process that is stopped
        std::int64_t captured = stopped - 1'000'000;
        for (std::uint32_t number = 1; number <= 8; ++number) {
            ASSERT_EQ(take(frame, 0ms), Got::frame);
            EXPECT_EQ(frame.sequence, number);
            captured += 33'333'000;
            if (old_clock) {
                EXPECT_FALSE(frame.stamped);
                EXPECT_GE(frame.monotonic_ns, stopped - 1'000'000);
                EXPECT_LE(frame.monotonic_ns, captured);
            } else {
                EXPECT_TRUE(frame.stamped);
                EXPECT_EQ(frame.monotonic_ns, captured);
            }
            stream_.give_back(frame.loan);
        }
        for (int i = 0; i < 20; ++i) {
            ASSERT_EQ(take(frame), Got::frame);
            EXPECT_EQ(frame.monotonic_ns, now_ns()) << "it was waited for";
            stream_.give_back(frame.loan);
        }
        stream_.close();
    }
}

TEST_F(VideoStreamTest, ATimeOfAnotherClockIsReplacedHoweverSlowTheCameraIs) {
    camera().old_clock = true;
    camera().period = 700ms;
    open_and_start();
    VideoFrame frame;
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(take(frame, 1s), Got::frame);
        EXPECT_EQ(frame.monotonic_ns, now_ns());
        stream_.give_back(frame.loan);
    }
}

TEST_F(VideoStreamTest, AFrameOfBeforeTheStartIsAsOldAsItSays) {
    camera().stamp_ahead = -3s;  // as a device has that another program feeds
    open_and_start();
    VideoFrame frame;
    ASSERT_EQ(take(frame), Got::frame);
    EXPECT_TRUE(frame.stamped);
    EXPECT_EQ(frame.monotonic_ns, now_ns() - 3'000'000'000);

    stream_.give_back(frame.loan);
    camera().stamp_ahead = -60s;
    ASSERT_EQ(take(frame), Got::frame);
    EXPECT_FALSE(frame.stamped) << "the clock may be another";
    EXPECT_EQ(frame.monotonic_ns, now_ns() - 60'000'000'000);
}

TEST_F(VideoStreamTest, AFrameThatMayBeOfBeforeTheStartHasATimeOrIsLeftOut) {
    for (const bool old_clock : {false, true}) {
        camera().old_clock = old_clock;
        open_and_start();
        const std::int64_t started = now_ns();
        system_.advance(40ms);  // one waits, and the driver was never seen empty
        VideoFrame frame;
        ASSERT_EQ(take(frame), Got::frame);
        EXPECT_EQ(frame.sequence, old_clock ? 1U : 0U);
        EXPECT_EQ(frame.stamped, !old_clock);
        EXPECT_EQ(frame.monotonic_ns, old_clock ? now_ns() : started + 33'333'000);
        stream_.close();
    }
}

TEST_F(VideoStreamTest, ADriverThatIsNeverEmptyIsNotLeftOutForEver) {
    camera().old_clock = true;
    open_and_start();
    system_.advance(1s);
    VideoFrame frame;
    EXPECT_EQ(take(frame, 0ms), Got::nothing) << "eight of before";
    const std::int64_t emptied = now_ns();
    system_.advance(1s);
    ASSERT_EQ(take(frame, 0ms), Got::frame);
    EXPECT_FALSE(frame.stamped);
    EXPECT_EQ(frame.monotonic_ns, emptied) << "since then the buffer was with the driver";
}

TEST_F(VideoStreamTest, ATimeThatCannotBeIsReplaced) {
    open_and_start();
    const std::int64_t now_s = system_.now().time_since_epoch() / 1s;
    // As a driver's clock that wraps around has them, and ones that are still to come.
    for (const std::int64_t stamp_s : {INT64_MIN, INT64_MIN / 1'000'000'000 - 1, std::int64_t{-1}, now_s + 2,
                                       now_s + 12, INT64_MAX / 1'000'000'000 + 1, INT64_MAX}) {
        camera().stamp_s = stamp_s;
        VideoFrame frame;
        ASSERT_EQ(take(frame), Got::frame);
        EXPECT_FALSE(frame.stamped) << stamp_s;
        EXPECT_EQ(frame.monotonic_ns, now_ns()) << stamp_s;
        stream_.give_back(frame.loan);
    }
}

TEST(FrameCounterTest, CountsGapsAcrossTheWrap) {
    FrameCounter counter;
    const auto expect = [&counter](std::uint32_t number, std::uint64_t sequence, std::uint32_t lost, bool gap) {
        const auto place = counter.place(number);
        EXPECT_EQ(place.sequence, sequence) << number;
        EXPECT_EQ(place.lost, lost) << number;
        EXPECT_EQ(place.discontinuity, gap) << number;
    };
    expect(0xfffffffdU, 0, 0, false);
    expect(0xfffffffeU, 1, 0, false);
    expect(1U, 4, 2, false);
    expect(2U, 5, 0, false);
    expect(0U, 6, 0, true);  // the driver has begun again by itself
    expect(0U, 7, 0, true);
    counter.restarted();
    expect(5U, 8, 0, true);
    expect(7U, 10, 1, false);
}

}  // namespace
}  // namespace disparityd::capture
