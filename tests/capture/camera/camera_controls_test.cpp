// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_controls.h"

#include <cerrno>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/camera/camera_source.h"
#include "capture/camera/zed_controls.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using test::FakeVideoSystem;
using test::zed2;
using ::testing::HasSubstr;

class CameraControlsTest : public ::testing::Test {
protected:
    CameraControlsTest() { system_.plug(zed2()).flash_serial = "4711"; }

    FakeVideoSystem::Camera& camera() { return system_.camera("/dev/video0"); }

    std::vector<CameraControl> control(const std::vector<CameraSetting>& settings) {
        return control_camera(system_, camera().usb, 30, settings);
    }

    std::uint8_t value(std::uint8_t part, std::uint32_t address) { return camera().registers[{part, address}]; }

    static std::int64_t find(const std::vector<CameraControl>& list, const std::string& name) {
        for (const CameraControl& control : list) {
            if (control.name == name) {
                return control.value;
            }
        }
        ADD_FAILURE() << "no " << name;
        return -1;
    }

    void expect_refusal(const CameraSetting& setting, const std::string& part) {
        try {
            control({{"brightness-auto", 7}, setting});
            ADD_FAILURE() << setting.name << " = " << setting.value << " was taken";
        } catch (const std::invalid_argument& error) {
            EXPECT_THAT(error.what(), HasSubstr(part));
        }
        EXPECT_EQ(camera().brightness, 4) << "something was set all the same";
    }

    FakeVideoSystem system_;
};

TEST_F(CameraControlsTest, EyesHaveExposureAndGainOfTheirOwn) {
    const auto list = control({{"auto-exposure", 0}, {"exposure-left", 1100}, {"gain-right", 1023}});
    // 1100 lines in sixteenths: 0x44c0.
    EXPECT_EQ(value(0xa3, 0x3500), 0x00);
    EXPECT_EQ(value(0xa3, 0x3501), 0x44);
    EXPECT_EQ(value(0xa3, 0x3502), 0xc0);
    EXPECT_EQ(value(0xa5, 0x3501), 0x00) << "the other eye";
    EXPECT_EQ(value(0xa5, 0x3508), 0x03);
    EXPECT_EQ(value(0xa5, 0x3509), 0xff);
    EXPECT_EQ(find(list, "exposure-left"), 1100);
    EXPECT_EQ(find(list, "gain-right"), 1023);
    EXPECT_EQ(find(list, "gain-left"), 0);
    EXPECT_EQ(find(list, "brightness-auto"), 4);
    EXPECT_EQ(system_.open_devices(), 0);
}

TEST_F(CameraControlsTest, AutoExposureIsOneBitOfBothEyes) {
    camera().registers[{0xa2, 0x80181033}] = 0x5d;
    camera().registers[{0xa2, 0x80181833}] = 0xff;
    EXPECT_EQ(find(control({}), "auto-exposure"), 0);
    EXPECT_EQ(find(control({{"auto-exposure", 1}}), "auto-exposure"), 1);
    EXPECT_EQ(value(0xa2, 0x80181033), 0x5f);
    EXPECT_EQ(find(control({{"auto-exposure", 0}}), "auto-exposure"), 0);
    EXPECT_EQ(value(0xa2, 0x80181033), 0x5d);
    EXPECT_EQ(value(0xa2, 0x80181833), 0xfd);
}

TEST_F(CameraControlsTest, NothingIsSetWhenOneIsWrong) {
    expect_refusal({"exposure-left", 1101}, "allowed: 2 .. 1100 lines");
    expect_refusal({"exposure-right", 1}, "allowed: 2 .. 1100 lines");
    expect_refusal({"gain-left", 300}, "allowed: 0 .. 255, 378 .. 511");
    expect_refusal({"auto-exposure", 2}, "allowed: 0 or 1");
    expect_refusal({"brightness-auto", 9}, "allowed: 0 .. 8");
    expect_refusal({"contrast", 1}, "allowed: auto-exposure, exposure-left, exposure-right, gain-left, gain-right, br");
}

TEST_F(CameraControlsTest, LimitsFollowTheRate) {
    EXPECT_EQ(longest_exposure(15), 1550);
    EXPECT_EQ(longest_exposure(30), 1100);
    EXPECT_EQ(longest_exposure(60), 880);
    EXPECT_EQ(longest_exposure(100), 720);
    for (const int gain : {0, 255, 378, 511, 890, 1023, 1914, 2047}) {
        EXPECT_TRUE(is_zed_gain(gain)) << gain;
    }
    for (const int gain : {-1, 256, 377, 512, 889, 1024, 1913, 2048}) {
        EXPECT_FALSE(is_zed_gain(gain)) << gain;
    }
}

TEST_F(CameraControlsTest, WithoutExtensionUnitThoseOfV4l2Remain) {
    camera().flash_serial = "";
    const auto list = control({{"brightness-auto", 2}});
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0].value, 2);
    camera().brightness = 4;
    expect_refusal({"gain-left", 1}, "allowed: brightness-auto");
}

TEST_F(CameraControlsTest, ACameraThatCannotBeOpenedSaysWhy) {
    camera().open_error = EACCES;
    EXPECT_THROW(control({}), std::runtime_error);
}

/// Sources that follow one another on a camera, as those of a daemon do that loads its configuration again.
class CameraSettingsKeptTest : public CameraControlsTest {
protected:
    void open(const std::string& controls, const std::string& uri = "v4l2:64x16@30") {
        SourceOptions options;
        options.uri = uri;
        options.wait_for_camera = true;
        options.controls = controls;
        options.control_overrides = overrides_;
        options.report = [this](const std::string& line, bool trouble) {
            troubles_ += trouble ? line + "\n" : std::string();
        };
        source_.reset();
        source_ = open_camera_on(system_, options);
    }

    void run() {
        for (int i = 0; i < 20; ++i) {
            RawFrame frame;
            if (source_->next(frame, system_.now() + 100ms) == FrameSource::Next::frame) {
                source_->give_back(frame);
            }
        }
    }

    void replug() {
        system_.unplug("/dev/video0");
        run();
        EXPECT_THROW(source_->set_camera_controls({}), std::runtime_error);
        auto again = zed2();
        again.flash_serial = "4711";
        system_.plug(again);
        run();
    }

    std::shared_ptr<ControlOverrides> overrides_ = std::make_shared<ControlOverrides>();
    std::unique_ptr<FrameSource> source_;
    std::string troubles_;
};

TEST_F(CameraSettingsKeptTest, ConfiguredControlsAndOverridesSurviveAReplug) {
    open("brightness-auto=6 gain-left=30");
    EXPECT_THROW(source_->set_camera_controls({}), std::runtime_error) << "not opened yet";
    run();
    EXPECT_EQ(camera().brightness, 6);
    EXPECT_EQ(value(0xa3, 0x3509), 30);
    source_->set_camera_controls({{"brightness-auto", 1}});
    EXPECT_EQ(camera().brightness, 1);
    replug();
    EXPECT_EQ(camera().brightness, 1) << "what was set last";
    EXPECT_EQ(value(0xa3, 0x3509), 30);
}

TEST_F(CameraSettingsKeptTest, WhatWasSetSurvivesAReloadAndAReplugAfterIt) {
    open("brightness-auto=6");
    run();
    source_->set_camera_controls({{"brightness-auto", 1}, {"gain-left", 77}});
    open("brightness-auto=6 gain-right=40");
    run();
    replug();
    EXPECT_EQ(camera().brightness, 1);
    EXPECT_EQ(value(0xa3, 0x3509), 77);
    EXPECT_EQ(value(0xa5, 0x3509), 40) << "newly configured, never set";
}

TEST_F(CameraSettingsKeptTest, AConfigurationThatChangesTheControlWins) {
    open("brightness-auto=6");
    run();
    source_->set_camera_controls({{"brightness-auto", 1}, {"gain-left", 77}});
    open("brightness-auto=3 gain-left=30");
    run();
    EXPECT_EQ(camera().brightness, 3);
    EXPECT_EQ(value(0xa3, 0x3509), 30);
    open("brightness-auto=6");
    run();
    EXPECT_EQ(camera().brightness, 6) << "what was overruled does not come back";
}

TEST_F(CameraSettingsKeptTest, AControlThatIsNoLongerConfiguredKeepsWhatWasSet) {
    open("brightness-auto=6");
    run();
    source_->set_camera_controls({{"brightness-auto", 1}});
    open("");
    replug();
    EXPECT_EQ(camera().brightness, 1);
}

TEST_F(CameraSettingsKeptTest, OneThatTheNewModeDoesNotTakeLeavesTheOthers) {
    open("");
    run();
    source_->set_camera_controls({{"exposure-left", 1100}, {"gain-left", 77}});
    open("brightness-auto=2", "v4l2:64x16@60");
    replug();
    EXPECT_EQ(camera().brightness, 2);
    EXPECT_EQ(value(0xa3, 0x3509), 77);
    EXPECT_THAT(troubles_, HasSubstr("exposure-left: found 1100, allowed: 2 .. 880 lines"));
}

TEST(CameraSettingsTest, AreNamesAndWholeNumbers) {
    const auto settings = parse_camera_settings(" auto-exposure=0  gain-left=-3 ", "here");
    ASSERT_EQ(settings.size(), 2U);
    EXPECT_EQ(settings[1].name, "gain-left");
    EXPECT_EQ(settings[1].value, -3);
    EXPECT_TRUE(parse_camera_settings("", "here").empty());
    for (const char* wrong : {"gain", "=3", "gain=", "gain=1.5", "gain=1e20", "gain=x", "gain=nan"}) {
        EXPECT_THROW(parse_camera_settings(wrong, "here"), std::invalid_argument) << wrong;
    }
}

}  // namespace
}  // namespace disparityd::capture
