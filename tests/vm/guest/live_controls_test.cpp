// SPDX-License-Identifier: Apache-2.0
//
// Controls that are set through the daemon arrive in the camera, and come back to it whatever happens in between.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/wire_client.h"
#include "tests/vm/guest/extension_client.h"
#include "tests/vm/guest/live_fixture.h"

namespace vm_guest {
namespace {

class LiveControls : public LiveTest {
protected:
    static void SetUpTestSuite() { start({"source.stall_ms=15000", "source.controls=gain-right=50"}); }

    /// What disparityctl camera asks for; the refusal, or nothing.
    static std::string set(const std::vector<std::pair<const char*, int>>& settings) {
        disparityd::test::WireClient client(daemon_->address());
        client.hello();
        disparityd::v1::Envelope request;
        for (const auto& [name, value] : settings) {
            auto& setting = *request.mutable_camera_request()->add_settings();
            setting.set_name(name);
            setting.set_value(value);
        }
        client.send(request);
        const auto answer = client.receive(patience);
        if (!answer) {
            return "no answer";
        }
        return answer->envelope.has_camera_controls() ? "" : answer->envelope.error().message();
    }

    static void expect_in_the_camera(int exposure_left, int gain_left, int gain_right) {
        const ExtensionClient unit(camera_->node().path);
        EXPECT_EQ(unit.exposure(ExtensionClient::left), exposure_left);
        EXPECT_EQ(unit.exposure(ExtensionClient::right), 512) << "never touched";
        EXPECT_EQ(unit.read_sensor(ExtensionClient::left, 0x3509), gain_left);
        EXPECT_EQ(unit.read_sensor(ExtensionClient::right, 0x3509), gain_right);
    }
};

TEST_F(LiveControls, ExposureAndGainArriveAndSurviveReloadAndReplug) {
    ASSERT_TRUE(streams());
    expect_in_the_camera(512, 0x40, 50);
    EXPECT_EQ(set({{"auto-exposure", 0}, {"exposure-left", 400}, {"gain-left", 30}, {"gain-right", 60}}), "");
    expect_in_the_camera(400, 30, 60);

    daemon_->reload();
    ASSERT_TRUE(streams());
    camera_->unplug();
    ASSERT_TRUE(daemon_->wait_for_camera("absent"));
    camera_->plug();
    {
        const ExtensionClient unit(camera_->node().path);
        EXPECT_TRUE(eventually([&unit] { return unit.read_sensor(ExtensionClient::right, 0x3509) == 60; }));
    }
    ASSERT_TRUE(streams());
    expect_in_the_camera(400, 30, 60);
}

TEST_F(LiveControls, WhatIsNotAllowedIsRefusedAndSetsNothing) {
    ASSERT_TRUE(streams());
    const int before = ExtensionClient(camera_->node().path).read_sensor(ExtensionClient::left, 0x3509);
    EXPECT_THAT(set({{"gain-left", 31}, {"exposure-left", 99999}}),
                testing::HasSubstr("exposure-left: found 99999, allowed: 2 .. 1550 lines"));
    EXPECT_EQ(ExtensionClient(camera_->node().path).read_sensor(ExtensionClient::left, 0x3509), before);
}

}  // namespace
}  // namespace vm_guest
