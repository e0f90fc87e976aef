// SPDX-License-Identifier: Apache-2.0
//
// What a driver can do to its user that the simulated camera cannot make it do: calls that fail, frames that it hands
// on although they are damaged, a device that is there and cannot be opened, numbers and times that begin again.
#include <cstdio>

#include <fcntl.h>
#include <gtest/gtest.h>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/guest/live_daemon.h"
#include "tests/vm/guest/vivid_device.h"

namespace vm_guest {
namespace {

using Status = LiveDaemon::Status;

class LiveVivid : public testing::Test {
protected:
    static void SetUpTestSuite() {
        daemon_ = std::make_unique<LiveDaemon>("v4l2:320x96@60?device=" + vivid_node());
        EXPECT_TRUE(daemon_->recovers()) << daemon_->log();
        at_start_ = daemon_->resources();
    }
    static void TearDownTestSuite() {
        if (daemon_) {
            EXPECT_TRUE(daemon_->comes_back_to(at_start_)) << at_start_ << "; now " << daemon_->resources();
            daemon_.reset();
        }
    }

    void SetUp() override { ASSERT_TRUE(daemon_->recovers()); }
    void TearDown() override {
        if (HasFailure()) {
            std::printf("%s%s\n", daemon_->log().c_str(), in_words(daemon_->status()).c_str());
        }
    }

    static void break_the_stream() { set_vivid("Inject Fatal Streaming Error"); }

    static bool streams() { return daemon_->wait_for_camera("streaming") && daemon_->wait_for_new_frame(); }

    static std::unique_ptr<LiveDaemon> daemon_;
    static LiveDaemon::Resources at_start_;
};

std::unique_ptr<LiveDaemon> LiveVivid::daemon_;
LiveDaemon::Resources LiveVivid::at_start_;

TEST_F(LiveVivid, AFlaggedFrameIsCountedAndNotServed) {
    const std::uint64_t damaged = daemon_->status().camera().damaged();
    set_vivid("Inject V4L2_BUF_FLAG_ERROR");
    EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.camera().damaged() == damaged + 1; }));
    EXPECT_TRUE(streams());
}

TEST_F(LiveVivid, FramesThatTheDriverLosesAreCounted) {
    const std::uint64_t lost = daemon_->status().lost();
    set_vivid("Percentage of Dropped Buffers", 50);
    EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.lost() >= lost + 20; }));
    set_vivid("Percentage of Dropped Buffers", 0);
    EXPECT_TRUE(streams());
}

TEST_F(LiveVivid, ABufferThatIsRefusedAndAStreamThatBreaksAreHelpedByARestart) {
    for (const char* fault : {"Inject VIDIOC_QBUF Error", "Inject Fatal Streaming Error"}) {
        ASSERT_TRUE(daemon_->recovers());
        const std::uint64_t restarts = daemon_->status().camera().restarts();
        set_vivid(fault);
        EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.camera().restarts() > restarts; }))
            << fault;
        EXPECT_TRUE(streams()) << fault;
    }
}

TEST_F(LiveVivid, ARestartThatFailsIsFollowedByOpeningAnew) {
    const std::uint64_t reopens = daemon_->status().camera().reopens();
    set_vivid("Inject VIDIOC_STREAMON Error");
    break_the_stream();
    EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.camera().reopens() > reopens; }));
    EXPECT_TRUE(streams());
}

TEST_F(LiveVivid, ADeviceThatGivesNoBuffersIsOpenedAgainAndAgain) {
    set_vivid("Inject VIDIOC_REQBUFS Error");
    set_vivid("Inject VIDIOC_STREAMON Error");
    break_the_stream();
    // It may be over before the next status is due.
    EXPECT_TRUE(eventually([] { return daemon_->log().find("gives no buffers") != std::string::npos; }));
    EXPECT_TRUE(streams());
}

TEST_F(LiveVivid, ADeviceThatIsDisconnectedIsUsedAgainWhenItIsBack) {
    {
        // The driver takes it back when its last user has closed it.
        const simulated_camera::FileDescriptor holder(::open(vivid_node().c_str(), O_RDWR | O_CLOEXEC));
        ASSERT_TRUE(holder);
        set_vivid("Disconnect");
        EXPECT_TRUE(daemon_->wait_for([](const Status& status) {
            return status.camera().state() == "absent" && status.state() == "waiting" &&
                   status.detail().find("check plug and cable") != std::string::npos;
        }));
    }
    EXPECT_TRUE(streams());
}

TEST_F(LiveVivid, NumbersAndTimesOfTheDriverMayWrapAround) {
    // From the next start on: numbers 128 before their end, times 16 s before theirs.
    set_vivid("Wrap Sequence Number");
    set_vivid("Wrap Timestamp");
    const std::uint64_t restarts = daemon_->status().camera().restarts();
    break_the_stream();
    ASSERT_TRUE(daemon_->wait_for([&](const Status& status) { return status.camera().restarts() > restarts; }));
    ASSERT_TRUE(streams());
    const std::uint64_t first = daemon_->frame().sequence;
    std::uint64_t last = first;
    while (last < first + 200) {
        ASSERT_TRUE(daemon_->wait_for_new_frame());
        const disparity::Frame& frame = daemon_->frame();
        EXPECT_GT(frame.sequence, last);
        EXPECT_LT(frame.sequence, last + 10000);
        EXPECT_LE(frame.monotonic_ns, monotonic_ns());
        last = frame.sequence;
    }
    set_vivid("Wrap Sequence Number", 0);
    set_vivid("Wrap Timestamp", 0);
    break_the_stream();
    EXPECT_TRUE(streams());
}

/// Both devices of the driver, as two cameras that are the eyes.
class LiveVividPair : public testing::Test {
protected:
    static constexpr int right = 1;

    bool streams() { return daemon_.wait_for_camera("streaming") && daemon_.wait_for_new_frame(); }

    void TearDown() override {
        if (HasFailure()) {
            std::printf("%s%s\n", daemon_.log().c_str(), in_words(daemon_.status()).c_str());
        }
    }

    LiveDaemon daemon_{"v4l2:160x96@30?left=" + vivid_node() + "&right=" + vivid_node(right)};
};

TEST_F(LiveVividPair, IsOneStereoSourceThatLosesAnEyeAndGetsItBack) {
    ASSERT_TRUE(daemon_.recovers());
    EXPECT_EQ(daemon_.status().camera().node(), vivid_node() + "," + vivid_node(right));
    {
        const simulated_camera::FileDescriptor holder(::open(vivid_node(right).c_str(), O_RDWR | O_CLOEXEC));
        ASSERT_TRUE(holder);
        set_vivid("Disconnect", 1, right);
        EXPECT_TRUE(daemon_.wait_for([](const Status& status) {
            return status.camera().state() == "absent" && status.state() == "waiting" &&
                   status.detail().find(vivid_node(right)) != std::string::npos;
        }));
    }
    EXPECT_TRUE(streams());
    const std::uint64_t restarts = daemon_.status().camera().restarts();
    set_vivid("Inject Fatal Streaming Error");
    EXPECT_TRUE(daemon_.wait_for([&](const Status& status) { return status.camera().restarts() > restarts; }));
    EXPECT_TRUE(streams());
}

TEST_F(LiveVividPair, CountsFramesWithoutPartner) {
    ASSERT_TRUE(daemon_.recovers());
    const Status before = daemon_.status();
    set_vivid("Percentage of Dropped Buffers", 50, right);
    EXPECT_TRUE(daemon_.wait_for([&](const Status& status) {
        return status.camera().unpaired() >= before.camera().unpaired() + 10 && status.lost() >= before.lost() + 10;
    }));
    set_vivid("Percentage of Dropped Buffers", 0, right);
    EXPECT_TRUE(daemon_.wait_for([](const Status& status) { return status.camera().has_eyes_apart(); }));
}

}  // namespace
}  // namespace vm_guest
