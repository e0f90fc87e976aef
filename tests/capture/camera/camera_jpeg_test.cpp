// SPDX-License-Identifier: Apache-2.0
//
// A camera that sends JPEGs, from the driver's buffers to the frames that are lent.
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <turbojpeg.h>

#include "capture/camera/camera_source.h"
#include "capture/source_condition.h"
#include "tests/capture/camera/fake_camera.h"
#include "tests/capture/camera/made_jpeg.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using Next = FrameSource::Next;
using test::Bytes;
using test::FakeVideoSystem;
using test::made_jpeg;
using test::planes_of;
using test::yuyv_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int sent_width = 128;
constexpr int sent_height = 64;

class CameraJpegTest : public ::testing::Test {
protected:
    CameraJpegTest() {
        auto camera = test::zed2();
        camera.width = sent_width;
        camera.height = sent_height;
        camera.format = V4L2_PIX_FMT_MJPEG;
        for (unsigned seed = 0; seed < 3; ++seed) {
            camera.jpegs.push_back(made_jpeg(sent_width, sent_height, TJSAMP_422, seed));
            pictures_.push_back(
                yuyv_of(planes_of(camera.jpegs.back(), sent_width, sent_height), sent_width, sent_height));
        }
        system_.plug(camera);
    }

    FakeVideoSystem::Camera& camera() { return system_.camera("/dev/video0"); }

    void open(int decoders) {
        SourceOptions options;
        options.uri = "v4l2:128x64@30?format=mjpeg";
        options.loans = 4;
        options.decoders = decoders;
        options.wait_for_camera = true;
        options.report = [this](const std::string& line, bool) { reports_.push_back(line); };
        source_ = open_camera_on(system_, options);
    }

    /// Waits for a frame, at most this long.
    bool next(RawFrame& frame, std::chrono::milliseconds most = 3s) {
        for (const auto until = system_.now() + most; system_.now() < until;) {
            if (source_->next(frame, until) == Next::frame) {
                return true;
            }
        }
        return false;
    }

    bool shows(const RawFrame& frame, std::size_t picture) const {
        const Bytes& expected = pictures_[picture % pictures_.size()];
        return frame.image.format == PixelFormat::yuyv && frame.image.eye_width == sent_width / 2 &&
               frame.image.height == sent_height && frame.image.stride == 2 * sent_width &&
               std::equal(expected.begin(), expected.end(), frame.image.data);
    }

    CameraFacts facts() const { return *source_->condition().camera; }

    FakeVideoSystem system_;
    std::vector<Bytes> pictures_;
    std::vector<std::string> reports_;
    std::unique_ptr<FrameSource> source_;
};

TEST_F(CameraJpegTest, FramesHaveThePixelsOfTheJpegs) {
    open(0);
    std::vector<RawFrame> out(4);
    for (std::size_t i = 0; i < out.size(); ++i) {
        ASSERT_TRUE(next(out[i]));
        EXPECT_EQ(out[i].sequence, i);
        EXPECT_EQ(out[i].dropped_before, 0U);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        EXPECT_TRUE(shows(out[i], i)) << "frame " << i << " keeps its pixels while it is lent";
    }
    RawFrame none;
    EXPECT_FALSE(next(none, 300ms)) << "all loans are out";
    for (const RawFrame& frame : out) {
        source_->give_back(frame);
    }
    ASSERT_TRUE(next(none));
    EXPECT_EQ(facts().state, CameraState::streaming);
    EXPECT_EQ(facts().damaged, 0U);
}

TEST_F(CameraJpegTest, ADamagedJpegIsCountedAndNotShown) {
    open(0);
    RawFrame frame;
    ASSERT_TRUE(next(frame));
    source_->give_back(frame);
    system_.fault({false, 700, 0});
    system_.fault({false, 900, 0});
    ASSERT_TRUE(next(frame));
    EXPECT_EQ(frame.sequence, 3U);
    EXPECT_EQ(frame.dropped_before, 2U);
    EXPECT_TRUE(shows(frame, 3));
    source_->give_back(frame);
    EXPECT_EQ(facts().damaged, 2U);
    EXPECT_EQ(std::count_if(reports_.begin(), reports_.end(),
                            [](const auto& line) { return line.find("damaged JPEG") != line.npos; }),
              1)
        << "one line for a stream";
}

TEST_F(CameraJpegTest, ACameraThatSendsDamageOnlyIsRestarted) {
    open(0);
    RawFrame frame;
    ASSERT_TRUE(next(frame));
    source_->give_back(frame);
    const auto whole = camera().jpegs;
    for (auto& jpeg : camera().jpegs) {
        jpeg.resize(jpeg.size() / 2);
    }
    EXPECT_FALSE(next(frame, 2500ms));
    EXPECT_EQ(facts().state, CameraState::stalled);
    EXPECT_GE(facts().restarts, 1U);
    camera().jpegs = whole;
    EXPECT_TRUE(next(frame));
    EXPECT_EQ(facts().state, CameraState::streaming);
}

TEST_F(CameraJpegTest, AnotherSizeThanAgreedIsSaid) {
    camera().jpegs = {made_jpeg(sent_width, sent_height / 2, TJSAMP_422, 0)};
    open(0);
    RawFrame frame;
    EXPECT_FALSE(next(frame, 1s));
    EXPECT_THAT(reports_, ::testing::Contains(HasSubstr("has 128x32 pixels, expected 128x64")));
}

TEST_F(CameraJpegTest, ACallerThatWasAwayIsNoStall) {
    open(0);
    RawFrame frame;
    ASSERT_TRUE(next(frame));
    source_->give_back(frame);
    system_.advance(5s);
    ASSERT_TRUE(next(frame));
    EXPECT_EQ(facts().restarts, 0U);
}

/// The clock runs on while the threads decode, so frames may be lost: what comes must be whole and in order.
TEST_F(CameraJpegTest, ThreadsGiveWholeFramesInOrderAcrossAnUnplugging) {
    open(2);
    std::uint64_t last = 0;
    for (int i = 0; i < 300; ++i) {
        if (i == 100) {
            system_.unplug("/dev/video0");
            auto again = test::zed2("/dev/video2");
            again.width = sent_width;
            again.height = sent_height;
            again.format = V4L2_PIX_FMT_MJPEG;
            again.usb.address = 9;
            again.jpegs.assign(1, made_jpeg(sent_width, sent_height, TJSAMP_422, 1));
            system_.plug(again);
        }
        RawFrame frame;
        // The clock of the camera runs ahead of the threads.
        const auto patience = std::chrono::steady_clock::now() + 60s;
        while (source_->next(frame, system_.now() + 10ms) != Next::frame) {
            ASSERT_LT(std::chrono::steady_clock::now(), patience) << i;
        }
        EXPECT_TRUE(i == 0 || frame.sequence > last);
        last = frame.sequence;
        const bool known = shows(frame, 0) || shows(frame, 1) || shows(frame, 2);
        EXPECT_TRUE(known) << i;
        EXPECT_TRUE(i < 120 || shows(frame, 1)) << i;
        source_->give_back(frame);
    }
    EXPECT_EQ(facts().damaged, 0U);
    source_.reset();
    EXPECT_EQ(system_.open_devices(), 0);
    EXPECT_EQ(system_.mapped(), 0);
}

}  // namespace
}  // namespace disparityd::capture
