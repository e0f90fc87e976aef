// SPDX-License-Identifier: Apache-2.0
//
// disparityctl beside a daemon on a camera: what people see and set by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/vm/guest/extension_client.h"
#include "tests/vm/guest/live_fixture.h"

namespace vm_guest {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class LiveCommands : public LiveTest {
protected:
    static void SetUpTestSuite() { start({"source.stall_ms=15000"}); }

    struct Said {
        int status = -1;
        std::string output;
        std::string error;
    };

    static Said ctl(const std::vector<std::string>& arguments) {
        const disparityd::test::TemporaryFolder folder;
        disparityd::test::DaemonProcess process(folder, arguments, {}, "/vm/disparityctl");
        const int status = process.wait_for_exit(3 * patience).value_or(-1);
        return {status, process.output(), process.log()};
    }

    static Said camera(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"camera", "--socket", daemon_->address()});
        return ctl(arguments);
    }

    /// The lines about the camera at this node in what `sources` has said.
    static std::string about(const VideoNode& node, const std::string& said) {
        const std::size_t place = said.find(node.path + ",");
        if (place == std::string::npos) {
            return node.path + " is not in " + said;
        }
        std::size_t end = said.find('\n', place);
        while (said.compare(end, 5, "\n    ") == 0) {
            end = said.find('\n', end + 1);
        }
        const std::size_t begin = said.rfind('\n', place) + 1;
        return said.substr(begin, end - begin);
    }
};

TEST_F(LiveCommands, CameraShowsControlsAndSetsThem) {
    const Said said = camera({"auto-exposure=0", "exposure-left=300", "gain-right=70"});
    ASSERT_EQ(said.status, 0) << said.error;
    EXPECT_THAT(said.output, AllOf(ContainsRegex("auto-exposure +0 "), ContainsRegex("exposure-left +300 +2 +1550"),
                                   ContainsRegex("exposure-right +512 "), ContainsRegex("gain-right +70 "),
                                   ContainsRegex("brightness +")));
    const ExtensionClient unit(camera_->node().path);
    EXPECT_EQ(unit.exposure(ExtensionClient::left), 300);
    EXPECT_EQ(unit.read_sensor(ExtensionClient::right, 0x3509), 70);
    EXPECT_TRUE(streams());
}

TEST_F(LiveCommands, CameraRefusesWithWhatIsAllowed) {
    const Said refused = camera({"exposure-left=400", "gain-left=300"});
    EXPECT_GT(refused.status, 0);
    EXPECT_THAT(refused.error, HasSubstr("gain-left: found 300, allowed: 0 .. 255"));
    EXPECT_NE(ExtensionClient(camera_->node().path).exposure(ExtensionClient::left), 400);
    EXPECT_TRUE(streams());
}

TEST_F(LiveCommands, SourcesListsCamerasAndWhatKeepsOneFromBeingUsed) {
    ASSERT_TRUE(streams());
    const CameraProcess slow({"--serial", "20202", "--model", "zed2i", "--usb2"});
    const Said said = ctl({"sources"});
    ASSERT_EQ(said.status, 0) << said.error;
    EXPECT_THAT(about(camera_->node(), said.output),
                AllOf(HasSubstr("ZED (serial 12345, "), HasSubstr("USB 5000 Mbit/s, firmware 1.00"),
                      HasSubstr("cannot be used: "), HasSubstr("in use by another program"),
                      HasSubstr("YUYV 2560x720 at 60, 30, 15 frames/s"), HasSubstr("YUYV 1344x376 at 100, 60")));
    EXPECT_THAT(about(slow.node(), said.output),
                AllOf(HasSubstr("ZED 2i (serial 20202, "), HasSubstr("USB 480 Mbit/s"), HasSubstr("on a USB 2 link"),
                      Not(HasSubstr("cannot be used")), HasSubstr("YUYV 1344x376"), Not(HasSubstr("2560x720"))));
    EXPECT_TRUE(streams());
}

}  // namespace
}  // namespace vm_guest
