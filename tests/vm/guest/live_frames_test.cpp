// SPDX-License-Identifier: Apache-2.0
//
// Frames on their way to a client that never reconnects, with damaged ones among them, and a camera that goes and
// comes.
#include <algorithm>
#include <fstream>
#include <optional>

#include <fcntl.h>
#include <gtest/gtest.h>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/guest/live_fixture.h"

namespace vm_guest {
namespace {

class LiveFrames : public LiveTest {
protected:
    // A host that stops for a while is not to look like a camera that has.
    static void SetUpTestSuite() { start({"source.stall_ms=15000"}); }
    void SetUp() override { ASSERT_TRUE(streams()); }
};

TEST_F(LiveFrames, FramesArriveAsTheCameraMadeThem) {
    std::optional<std::uint32_t> last;
    for (int i = 0; i < 5; ++i) {
        ASSERT_TRUE(daemon_->wait_for_new_frame());
        EXPECT_NE(daemon_->frame().flags & disparity::unrectified, 0U);
        const auto number = number_of_left_picture(*daemon_->frame().plane(disparity::Product::left));
        ASSERT_TRUE(number);
        EXPECT_TRUE(!last || *number > *last);
        last = number;
    }
}

TEST_F(LiveFrames, FramesThroughSharedMemoryAreTheSame) {
    disparity::SharedMemoryReader reader(daemon_->name());
    disparity::Frame frame;
    for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(reader.read(frame, patience), disparity::ReadResult::frame);
        EXPECT_TRUE(number_of_left_picture(*frame.plane(disparity::Product::left)));
    }
}

TEST_F(LiveFrames, ErroneousAndShortFramesAreCountedAndNotServed) {
    for (const char* fault : {"err 2", "short 2"}) {
        const std::uint64_t lost = daemon_->status().lost();
        camera_->tell(fault);
        EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.lost() >= lost + 2; })) << fault;
        EXPECT_TRUE(streams());
    }
}

TEST_F(LiveFrames, FramesThatTheCameraLeavesOutAreNoTrouble) {
    const auto number = [] { return number_of_left_picture(*daemon_->frame().plane(disparity::Product::left)); };
    const auto before = number();
    ASSERT_TRUE(before);
    camera_->tell("drop 30");
    EXPECT_TRUE(eventually([&] { return daemon_->wait_for_new_frame() && number() && *number() > *before + 30; }));
    EXPECT_TRUE(streams());
}

/// From the next plugging on, uvcvideo hands damaged frames on instead of dropping them.
class DriverKeepsDamagedFrames {
public:
    DriverKeepsDamagedFrames() { set('1'); }
    ~DriverKeepsDamagedFrames() { set('0'); }
    DriverKeepsDamagedFrames(const DriverKeepsDamagedFrames&) = delete;
    DriverKeepsDamagedFrames& operator=(const DriverKeepsDamagedFrames&) = delete;

private:
    static void set(char value) { std::ofstream("/sys/module/uvcvideo/parameters/nodrop") << value; }
};

TEST_F(LiveFrames, DamagedFramesThatTheDriverHandsOnAreCountedAndNotServed) {
    camera_->unplug();
    {
        const DriverKeepsDamagedFrames keeps;
        camera_->plug();
    }
    ASSERT_TRUE(streams());
    for (const char* fault : {"err 2", "short 2"}) {
        const auto kept = [](const Status& status) { return status.camera().damaged() + status.camera().too_short(); };
        const std::uint64_t before = kept(daemon_->status());
        camera_->tell(fault);
        EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return kept(status) >= before + 2; })) << fault;
        EXPECT_TRUE(streams());
    }
    camera_->unplug();
    camera_->plug();
    EXPECT_TRUE(streams());
}

TEST_F(LiveFrames, ACameraThatTheKernelMaySuspendIsANotice) {
    const auto is_said = [] {
        const Status status = daemon_->status();
        return std::any_of(status.notices().begin(), status.notices().end(), [](const std::string& notice) {
            return notice.find("the kernel may suspend ZED") != std::string::npos;
        });
    };
    for (const bool automatic : {true, false}) {
        std::ofstream(camera_->node().usb_path + "/power/control") << (automatic ? "auto" : "on");
        daemon_->reload();
        ASSERT_TRUE(streams());
        EXPECT_EQ(is_said(), automatic);
    }
}

TEST_F(LiveFrames, ASingleStallIsOver) {
    const std::uint64_t damaged = daemon_->status().camera().damaged();
    camera_->tell("stall 1");
    EXPECT_TRUE(daemon_->wait_for([&](const Status& status) { return status.camera().damaged() > damaged; }));
    EXPECT_TRUE(streams());
}

TEST_F(LiveFrames, UnplugIsSeenAndTheCameraComesBackUnderAnotherNodeNumber) {
    const std::string node = camera_->node().path;
    // Somebody who holds the node keeps its number from being used again.
    const simulated_camera::FileDescriptor holder(::open(node.c_str(), O_RDWR | O_CLOEXEC));
    camera_->unplug();
    EXPECT_TRUE(daemon_->wait_for([](const Status& status) {
        return status.camera().state() == "absent" && status.state() == "waiting" &&
               status.detail().find("plug") != std::string::npos;
    }));
    camera_->plug();
    EXPECT_NE(camera_->node().path, node);
    EXPECT_TRUE(streams());
    EXPECT_EQ(daemon_->status().camera().node(), camera_->node().path);
}

TEST_F(LiveFrames, AnotherCameraMayTakeItsPlace) {
    camera_->unplug();
    camera_->plug("zed2i 20202");
    EXPECT_TRUE(daemon_->wait_for([](const Status& status) {
        return status.camera().state() == "streaming" && status.camera().serial() == "20202" &&
               status.camera().model() == "ZED 2i";
    }));
    EXPECT_TRUE(streams());
    camera_->unplug();
    camera_->plug("zed 12345");
    EXPECT_TRUE(daemon_->wait_for([](const Status& status) {
        return status.camera().state() == "streaming" && status.camera().serial() == "12345";
    }));
}

TEST_F(LiveFrames, ReplugsLeaveNothingBehindAndAreOverSoon) {
    const LiveDaemon::Resources before = daemon_->resources();
    std::vector<double> seconds_to_a_frame;
    for (int i = 0; i < 15; ++i) {
        camera_->unplug();
        ASSERT_TRUE(daemon_->wait_for_camera("absent")) << "time " << i;
        camera_->plug();
        const auto back = std::chrono::steady_clock::now();
        ASSERT_TRUE(daemon_->wait_for_new_frame()) << "time " << i;
        seconds_to_a_frame.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - back).count());
    }
    ASSERT_TRUE(streams());
    EXPECT_EQ(daemon_->resources(), before);
    // A host with other work may hold up some of them.
    std::sort(seconds_to_a_frame.begin(), seconds_to_a_frame.end());
    std::printf("seconds to the first frame: least %.2f, median %.2f, most %.2f\n", seconds_to_a_frame.front(),
                seconds_to_a_frame[7], seconds_to_a_frame.back());
    EXPECT_LT(seconds_to_a_frame[7], 2.0);
}

}  // namespace
}  // namespace vm_guest
