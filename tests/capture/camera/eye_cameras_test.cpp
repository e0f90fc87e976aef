// SPDX-License-Identifier: Apache-2.0
//
// Which camera is which eye.
#include "capture/camera/eye_cameras.h"

#include <fstream>
#include <utility>

#include <gmock/gmock.h>

#include "tests/capture/camera/pair_fixture.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

using namespace std::chrono_literals;
using test::CameraPairTest;
using test::left_node;
using test::pair_uri;
using test::right_node;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(CameraPairTest, OneCameraIsNotTwo) {
    SourceOptions options;
    options.uri = "v4l2:64x16@30?left=/dev/video0&right=port:1-1";
    try {
        open_camera_on(system_, options);
        ADD_FAILURE() << "one camera passed for two";
    } catch (const std::invalid_argument& error) {
        EXPECT_THAT(error.what(), HasSubstr("both are USB Camera (serial A1, /dev/video0, USB port 1-1)"));
    }
}

TEST_F(CameraPairTest, OneCameraThatComesLaterIsNotTwo) {
    system_.unplug(left_node);
    system_.unplug(right_node);
    for (const char* uri :
         {"v4l2:64x16@30?left=/dev/video0&right=port:1-1", "v4l2:64x16@30?left=serial:A1&right=port:1-1"}) {
        open(uri);
        run(1s);
        plug(left_node, "1-1", "A1");
        EXPECT_EQ(run(2s), 0);
        EXPECT_EQ(facts().state, CameraState::failed);
        EXPECT_THAT(detail(), HasSubstr("both are USB Camera (serial A1, /dev/video0, USB port 1-1)"));
        system_.unplug(left_node);
    }
}

TEST_F(CameraPairTest, CamerasThatGetEachOthersNodesKeepTheirEyes) {
    const auto plug_as = [this](const std::string& node, const std::string& port, const std::string& serial,
                                std::uint8_t grey, int address) {
        auto& camera = plug(node, port, serial);
        camera.usb.address = address;
        camera.draw = [grey](std::uint32_t, std::vector<std::uint8_t>& picture) {
            picture.assign(picture.size(), grey);
        };
    };
    using Serials = std::pair<const char*, const char*>;
    for (const auto& [one, two] : {Serials{"", ""}, Serials{"1", "1"}, Serials{"A1", "B2"}}) {
        plug_as(left_node, "1-1", one, 10, 11);
        plug_as(right_node, "1-2", two, 20, 12);
        open();
        EXPECT_GT(run(1s), 20);
        system_.unplug(left_node);
        system_.unplug(right_node);
        run(1s);
        plug_as(left_node, "1-2", two, 20, 21);
        EXPECT_EQ(run(1s), 0);
        EXPECT_THAT(detail(), HasSubstr("was unplugged"));
        plug_as(right_node, "1-1", one, 10, 22);
        RawFrame frame;
        ASSERT_TRUE(next(frame)) << one << detail();
        EXPECT_EQ(frame.image.eye(Eye::left).row(0)[0], 10) << one;
        EXPECT_EQ(frame.image.eye(Eye::right).row(0)[0], 20) << one;
        EXPECT_EQ(facts().node, "/dev/video2,/dev/video0");
        EXPECT_EQ(facts().port, "1-1,1-2");
        source_->give_back(frame);
    }
}

TEST_F(CameraPairTest, EyesThatNothingTellsApartAreNotGuessed) {
    const auto replug = [this](const std::vector<const char*>& nodes) {
        for (const char* node : nodes) {
            system_.unplug(node);
        }
        if (source_) {
            run(1s);
        }
        for (const char* node : nodes) {
            auto& camera = plug(node, "1-7", "");
            camera.usb.port = "";
            camera.usb.address = camera.usb.bus = 0;
        }
    };
    replug({left_node, right_node});
    open();
    EXPECT_GT(run(1s), 20);
    replug({right_node});
    EXPECT_GT(run(2s), 20) << "the other one was there";
    reports_.clear();
    replug({left_node, right_node});
    EXPECT_LE(run(3s), 1);
    EXPECT_EQ(facts().state, CameraState::failed);
    EXPECT_FALSE(source_->condition().delivering);
    EXPECT_THAT(detail(), HasSubstr("the eyes cannot be told apart: both cameras were gone at once, and USB Camera"));
    EXPECT_EQ(reported("cannot be told apart"), 1);
}

UsbCamera usb_camera(const std::string& node, const std::string& port, const std::string& serial, int address) {
    UsbCamera camera;
    camera.node = node;
    camera.port = port;
    camera.serial = serial;
    camera.bus = 1;
    camera.address = address;
    return camera;
}

std::vector<std::string> ports(const EyeCameras::Choice& choice) {
    std::vector<std::string> list;
    for (const UsbCamera& camera : choice.cameras) {
        list.push_back(camera.port);
    }
    EXPECT_NE(list.empty(), !choice.problem) << "one of both";
    return list;
}

TEST(EyeCamerasTest, TheCameraOfOneEyeIsNotTakenForThatOfTheOtherWhichNeverHadOne) {
    for (const char* serial : {"", "B2"}) {
        EyeCameras eyes(parse_camera_uri(pair_uri));
        const UsbCamera first = usb_camera(right_node, "1-2", serial, 1);
        eyes.opened(Eye::right, first);
        eyes.unplugged(Eye::right);
        const UsbCamera again = usb_camera(left_node, "1-2", serial, 2);
        const auto left = eyes.choose(Eye::left, {again});
        EXPECT_THAT(ports(left), IsEmpty()) << serial;
        EXPECT_THAT(left.problem->detail, HasSubstr("the left eye waits for the camera of the right one, " +
                                                    first.label() + ": what is at /dev/video0 may be that one"));
        EXPECT_THAT(ports(eyes.choose(Eye::right, {again})), ElementsAre("1-2")) << serial;

        // Moved, it has its serial number at most.
        const UsbCamera moved = usb_camera(left_node, "1-4", serial, 3);
        EXPECT_THAT(ports(eyes.choose(Eye::left, {moved})), IsEmpty()) << serial;
        const bool another = *serial != '\0';
        EXPECT_EQ(ports(eyes.choose(Eye::left, {usb_camera(left_node, "1-1", "A1", 4)})).size(), another ? 1U : 0U);

        // While the right one is there, what else is plugged in is another.
        eyes.opened(Eye::right, first);
        EXPECT_THAT(ports(eyes.choose(Eye::left, {first, moved})), ElementsAre("1-4")) << serial;
    }
}

TEST(EyeCamerasTest, AnotherCameraIsNotAnEyesWhileTheOtherEyeNeverHadOne) {
    EyeCameras eyes(parse_camera_uri(pair_uri));
    eyes.opened(Eye::right, usb_camera(right_node, "1-2", "", 1));
    eyes.unplugged(Eye::right);
    const UsbCamera other = usb_camera(right_node, "1-1", "", 2);
    const auto right = eyes.choose(Eye::right, {other});
    EXPECT_THAT(ports(right), IsEmpty());
    EXPECT_THAT(right.problem->detail,
                HasSubstr(other.label() + " may be the other eye's: plug the eye's own in where it was"));
    const UsbCamera left = usb_camera(left_node, "1-7", "", 3);
    eyes.opened(Eye::left, left);
    EXPECT_THAT(ports(eyes.choose(Eye::right, {other, left})), ElementsAre("1-1"));
}

TEST(EyeCamerasTest, TheSerialNumberGoesBeforeThePlaceInWhateverOrderTheyAreListed) {
    EyeCameras eyes(parse_camera_uri(pair_uri));
    const UsbCamera right = usb_camera(right_node, "1-2", "B2", 2);
    eyes.opened(Eye::left, usb_camera(left_node, "1-1", "A1", 1));
    eyes.opened(Eye::right, right);
    eyes.unplugged(Eye::left);
    const UsbCamera in_its_place = usb_camera(left_node, "1-1", "C3", 3);
    const UsbCamera own = usb_camera("/dev/video4", "1-4", "A1", 4);
    EXPECT_THAT(ports(eyes.choose(Eye::left, {in_its_place, right, own})), ElementsAre("1-4"));
    EXPECT_THAT(ports(eyes.choose(Eye::left, {own, right, in_its_place})), ElementsAre("1-4"));
    EXPECT_THAT(ports(eyes.choose(Eye::left, {in_its_place, right})), ElementsAre("1-1")) << "put in for it";

    // Where a number is there twice, the place tells.
    EyeCameras twins(parse_camera_uri(pair_uri));
    twins.opened(Eye::right, usb_camera(right_node, "1-2", "B2", 1));
    twins.unplugged(Eye::right);
    const UsbCamera twin = usb_camera(left_node, "1-1", "B2", 2);
    EXPECT_THAT(ports(twins.choose(Eye::right, {twin, usb_camera("/dev/video4", "1-2", "B2", 3)})), ElementsAre("1-2"));
}

TEST_F(CameraPairTest, TheCalibrationIsThatOfBothSerialNumbers) {
    const disparityd::test::TemporaryFolder folder;
    const auto write = [&folder](const std::string& serials, const std::string& baseline) {
        const std::string keys = "fx=264\nfy=264\ncx=330\ncy=190\nk1=-0.04\nk2=0.01\n";
        std::ofstream(folder.file("SN" + serials + ".conf"))
            << "[LEFT_CAM_VGA]\n"
            << keys << "[RIGHT_CAM_VGA]\n"
            << keys << "[STEREO]\nBaseline=" << baseline
            << "\nTY=0.1\nTZ=0.2\nCV_VGA=0.01\nRX_VGA=0.001\nRZ_VGA=0.002\n";
    };
    write("A1-B2", "60");
    for (auto* camera : {&left(), &right()}) {
        camera->width = 672;
        camera->height = 376;
    }
    SourceOptions options;
    options.calibration_folders = {folder.path()};
    options.allow_unrectified = false;
    open("v4l2:672x376@30?left=port:1-1&right=port:1-2", options);
    ASSERT_TRUE(source_->info().calibration);
    EXPECT_EQ(source_->info().serial, "A1-B2");
    EXPECT_GT(run(1s), 20);
    EXPECT_THAT(notices(), IsEmpty());

    // Another camera in the place of one: the calibration does not hold for it.
    system_.unplug(right_node);
    run(500ms);
    auto& other = plug(right_node, "1-2", "C3");
    other.width = 672;
    other.height = 376;
    EXPECT_EQ(run(3s), 0);
    EXPECT_EQ(facts().state, CameraState::no_calibration);
    EXPECT_THAT(detail(), HasSubstr("put SNA1-C3.conf into"));
    write("A1-C3", "70");
    EXPECT_EQ(run(2s), 0);
    EXPECT_EQ(facts().state, CameraState::changed);
    EXPECT_TRUE(source_->condition().reopen);
    EXPECT_FALSE(source_->condition().delivering);
    open("v4l2:672x376@30?left=port:1-1&right=port:1-2", options);
    EXPECT_GT(run(1s), 20);
    EXPECT_EQ(source_->info().calibration->translation[0], -70);

    // Numbers that are the same tell nothing apart.
    system_.unplug(right_node);
    plug(right_node, "1-2", "A1") = [&] {
        auto same = left();
        same.usb.node = right_node;
        same.usb.port = "1-2";
        return same;
    }();
    open("v4l2:672x376@30?left=port:1-1&right=port:1-2", options);
    EXPECT_EQ(run(3s), 0);
    EXPECT_THAT(detail(), HasSubstr("no serial numbers tell the two apart, so name a file with [source] calibration"));
    options.allow_unrectified = true;
    open("v4l2:672x376@30?left=port:1-1&right=port:1-2", options);
    EXPECT_GT(run(1s), 20);
    EXPECT_THAT(notices(), Contains(HasSubstr("frames are unrectified")));
}

}  // namespace
}  // namespace disparityd::capture
