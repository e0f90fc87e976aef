// SPDX-License-Identifier: Apache-2.0
//
// Stamps are moved to the centre of the exposure where that is asked for and the driver reports one; a frame says so.
#include <gmock/gmock.h>

#include "capture/camera/camera_source.h"
#include "capture/source_condition.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using Next = FrameSource::Next;
using test::FakeVideoSystem;

constexpr std::int64_t ms = 1'000'000;

class ExposureStampTest : public ::testing::Test {
protected:
    FakeVideoSystem::Camera& plug(std::int32_t exposure) {
        FakeVideoSystem::Camera camera = test::zed2();
        camera.exposure = exposure;
        return system_.plug(camera);
    }

    void open(Stamp stamp) {
        SourceOptions options;
        options.uri = "v4l2:64x16@30";
        options.wait_for_camera = true;
        options.stamp = stamp;
        source_ = open_camera_on(system_, options);
    }

    RawFrame next() {
        RawFrame frame;
        for (int tries = 0; tries < 100; ++tries) {
            if (source_->next(frame, system_.now() + 100ms) == Next::frame) {
                source_->give_back(frame);
                return frame;
            }
        }
        ADD_FAILURE() << "no frame came";
        return frame;
    }

    /// How far the stamp of the next frame is from the clock, which stands still when the frame has come.
    std::int64_t moved() {
        const std::int64_t stamp = next().monotonic_ns;
        return stamp - std::chrono::nanoseconds(system_.now().time_since_epoch()).count();
    }

    FakeVideoSystem system_;
    std::unique_ptr<FrameSource> source_;
};

TEST_F(ExposureStampTest, IsTheDriversUnlessAskedFor) {
    plug(80);
    open(Stamp::source);
    EXPECT_EQ(next().flags, frame_flag_none);
    EXPECT_EQ(moved() / ms, 0);
    EXPECT_EQ(system_.count("exposure"), 0) << "nobody needs it";
}

TEST_F(ExposureStampTest, IsHalfAnExposureBeforeTheFirstPacket) {
    plug(80);
    open(Stamp::exposure_centre);
    const RawFrame frame = next();
    EXPECT_EQ(frame.flags, frame_flag_exposure_centre);
    EXPECT_EQ(frame.realtime_ns - frame.monotonic_ns, 1'700'000'000'000'000'000) << "both clocks tell the same instant";
    EXPECT_EQ(moved() / ms, -4);
    EXPECT_THAT(source_->condition().notices, Not(Contains(HasSubstr("exposure"))));
}

TEST_F(ExposureStampTest, IsHalfAnExposureBehindItsStartWhereTheCameraStamps) {
    system_.begin_exposure = true;
    plug(80);
    open(Stamp::exposure_centre);
    EXPECT_EQ(next().flags, frame_flag_exposure_centre);
    EXPECT_EQ(moved() / ms, -4);
}

TEST_F(ExposureStampTest, StaysWhenTheFrameCameWhereTheDriversStampIsOfAnotherClock) {
    system_.begin_exposure = true;
    plug(80).old_clock = true;
    open(Stamp::exposure_centre);
    EXPECT_EQ(next().flags, frame_flag_none);
    EXPECT_EQ(moved() / ms, 0);
}

TEST_F(ExposureStampTest, FollowsTheExposureAndAsksTwiceASecond) {
    plug(80);
    open(Stamp::exposure_centre);
    EXPECT_EQ(moved() / ms, -4);
    system_.camera("/dev/video0").exposure = 200;
    for (int i = 0; i < 30; ++i) {
        next();
    }
    EXPECT_EQ(moved() / ms, -10);
    EXPECT_LE(system_.count("exposure"), 4);
}

TEST_F(ExposureStampTest, StaysTheDriversWhereNoExposureIsReported) {
    plug(0);
    open(Stamp::exposure_centre);
    EXPECT_EQ(next().flags, frame_flag_none);
    EXPECT_EQ(moved() / ms, 0);
    EXPECT_THAT(source_->condition().notices, Contains(HasSubstr("does not report the exposure")));
}

TEST_F(ExposureStampTest, StaysTheDriversWhereTheExposureCannotBe) {
    // The last one lasts longer than from frame to frame.
    for (const std::int32_t exposure : {-5, 100'001, 5000}) {
        FakeVideoSystem::Camera& camera = exposure < 0 ? plug(exposure) : system_.camera("/dev/video0");
        camera.exposure = exposure;
        open(Stamp::exposure_centre);
        EXPECT_EQ(next().flags, frame_flag_none) << exposure;
        source_.reset();
    }
}

}  // namespace
}  // namespace disparityd::capture
