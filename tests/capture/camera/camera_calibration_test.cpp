// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "calibration/calibration_lookup.h"
#include "capture/camera/camera_source.h"
#include "capture/camera/camera_survey.h"
#include "capture/camera/zed_extension.h"
#include "capture/source_condition.h"
#include "tests/capture/camera/fake_camera.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::FakeVideoSystem;
using test::zed2;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* camera_keys = "fx=264\nfy=264\ncx=330\ncy=190\nk1=-0.04\nk2=0.01\n";

/// A camera that sends VGA frames, and folders with calibrations.
class CameraCalibrationTest : public ::testing::Test {
protected:
    CameraCalibrationTest()
        : folder_((fs::temp_directory_path() / ("calibrations-" + std::to_string(getpid()))).string()) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~CameraCalibrationTest() override { fs::remove_all(folder_); }
    CameraCalibrationTest(const CameraCalibrationTest&) = delete;
    CameraCalibrationTest& operator=(const CameraCalibrationTest&) = delete;

    void write(const std::string& serial, const std::string& baseline = "120", const std::string& cv = "0.01") {
        std::ofstream(folder_ + "/SN" + serial + ".conf")
            << "[LEFT_CAM_VGA]\n"
            << camera_keys << "[RIGHT_CAM_VGA]\n"
            << camera_keys << "[STEREO]\nBaseline=" << baseline << "\nTY=0.1\nTZ=0.2\nCV_VGA=" << cv
            << "\nRX_VGA=0.001\nRZ_VGA=0.002\n";
    }

    FakeVideoSystem::Camera& plug(const std::string& serial, const std::string& node = "/dev/video0",
                                  const std::string& port = "2-1") {
        auto camera = zed2(node, serial);
        camera.usb.port = port;
        camera.width = 1344;
        camera.height = 376;
        return system_.plug(camera);
    }

    void open(bool allow_unrectified = false) {
        SourceOptions options;
        options.allow_unrectified = allow_unrectified;
        options.calibration_folders = {folder_ + "/none", folder_};
        open_with(options);
    }

    void open_with(SourceOptions options) {
        options.uri = "v4l2:vga@30";
        options.wait_for_camera = true;
        source_.reset();
        source_ = open_camera_on(system_, options);
    }

    /// As the daemon does when the source wants to be opened anew.
    void open_anew(SourceOptions options) {
        ASSERT_TRUE(source_->condition().reopen);
        options.likely_port = source_->condition().camera->port;
        open_with(options);
    }

    int run(std::chrono::milliseconds time) {
        int frames = 0;
        for (const auto until = system_.now() + time; system_.now() < until;) {
            RawFrame frame;
            if (source_->next(frame, std::min(until, system_.now() + 100ms)) == FrameSource::Next::frame) {
                ++frames;
                source_->give_back(frame);
            }
        }
        return frames;
    }

    CameraState state() const { return source_->condition().camera->state; }

    const std::string folder_;
    FakeVideoSystem system_;
    std::unique_ptr<FrameSource> source_;
};

TEST_F(CameraCalibrationTest, IsFoundByTheSerialNumber) {
    plug("12345");
    write("12345");
    write("999", "63");
    open();
    ASSERT_TRUE(source_->info().calibration);
    EXPECT_EQ(source_->info().calibration->translation[0], -120);
    EXPECT_GT(run(500ms), 0);
    EXPECT_THAT(source_->condition().notices, ElementsAre());
}

TEST_F(CameraCalibrationTest, OfACameraThatIsNotThereYetIsFoundWhenItComes) {
    write("12345");
    open();
    EXPECT_FALSE(source_->info().calibration);
    run(1s);
    EXPECT_FALSE(source_->condition().reopen);
    plug("12345");
    EXPECT_EQ(run(1s), 0) << "not with the wrong calibration";
    EXPECT_EQ(state(), CameraState::changed);
    EXPECT_TRUE(source_->condition().reopen);
    open();
    EXPECT_GT(run(500ms), 0);
}

TEST_F(CameraCalibrationTest, AnotherCameraInItsPlaceAsksForItsOwn) {
    plug("12345");
    write("12345");
    write("999", "63");
    open();
    run(1s);
    system_.unplug("/dev/video0");
    run(1s);
    plug("999");
    EXPECT_EQ(run(1s), 0);
    EXPECT_TRUE(source_->condition().reopen);
    EXPECT_THAT(source_->condition().detail, HasSubstr("SN999.conf"));
}

TEST_F(CameraCalibrationTest, ASourceIsThatOfOneSerialNumberThoughAnotherHasTheSameCalibration) {
    write("12345");
    SourceOptions options;
    options.calibration_path = folder_ + "/SN12345.conf";
    open_with(options);
    EXPECT_EQ(source_->info().serial, "") << "not there yet";
    plug("12345");
    EXPECT_EQ(run(1s), 0) << "not with what is known of any other camera";
    open_anew(options);
    EXPECT_EQ(source_->info().serial, "12345");
    EXPECT_GT(run(1s), 0);
    system_.unplug("/dev/video0");
    run(1s);
    plug("12345");
    EXPECT_GT(run(1s), 0) << "the same one again";
    system_.unplug("/dev/video0");
    run(1s);
    plug("999");
    EXPECT_EQ(run(1s), 0);
    EXPECT_EQ(source_->info().serial, "12345");
    EXPECT_THAT(source_->condition().detail, HasSubstr("is not the camera with serial 12345"));
    open_anew(options);
    EXPECT_EQ(source_->info().serial, "999");
    EXPECT_GT(run(1s), 0);
}

TEST_F(CameraCalibrationTest, WithoutCalibrationAnotherCameraNeedsNothingNew) {
    plug("12345");
    open(true);
    EXPECT_GT(run(1s), 0);
    EXPECT_EQ(source_->info().serial, "");
    system_.unplug("/dev/video0");
    run(1s);
    plug("999");
    EXPECT_GT(run(1s), 0);
}

TEST_F(CameraCalibrationTest, OfTwoCamerasTheOneThatCanBeUsedSettlesIt) {
    write("12345");
    write("999", "63");
    plug("12345").buffers_error = EBUSY;
    plug("999", "/dev/video2", "2-2");
    SourceOptions options;
    options.calibration_folders = {folder_};
    open_with(options);
    EXPECT_EQ(source_->info().serial, "12345");
    EXPECT_EQ(run(1s), 0);
    open_anew(options);
    EXPECT_EQ(source_->info().serial, "999");
    EXPECT_GT(run(1s), 0);
    system_.camera("/dev/video0").buffers_error = 0;
    options.likely_port = source_->condition().camera->port;
    open_with(options);
    EXPECT_EQ(source_->info().serial, "999") << "a reload stays with the camera that was in use";
}

TEST_F(CameraCalibrationTest, WithoutWaitingTheCameraThatCanBeUsedIsUsed) {
    write("12345");
    write("999", "63");
    plug("12345").buffers_error = EBUSY;
    plug("999", "/dev/video2", "2-2");
    SourceOptions options;
    options.uri = "v4l2:vga@30";
    options.calibration_folders = {folder_};
    source_ = open_camera_on(system_, options);
    EXPECT_EQ(source_->info().serial, "999");
    EXPECT_GT(run(1s), 0);
}

TEST_F(CameraCalibrationTest, ACameraThatUdevHasNotPreparedYetIsNoOtherCamera) {
    write("12345");
    plug("OV0001").flash_serial = "12345";
    open(true);
    EXPECT_EQ(source_->info().serial, "12345");
    EXPECT_GT(run(1s), 0);
    system_.unplug("/dev/video0");
    run(1s);
    auto& again = plug("OV0001");
    again.flash_serial = "12345";
    again.open_error = EACCES;
    EXPECT_EQ(run(500ms), 0);
    EXPECT_EQ(state(), CameraState::starting);
    EXPECT_FALSE(source_->condition().reopen);
    again.open_error = 0;
    EXPECT_GT(run(1s), 0);
}

TEST_F(CameraCalibrationTest, MissingIsRefusedUnlessUnrectifiedIsAllowed) {
    plug("12345");
    open();
    EXPECT_EQ(run(1s), 0);
    EXPECT_EQ(state(), CameraState::no_calibration);
    EXPECT_THAT(source_->condition().detail, HasSubstr("put SN12345.conf into " + folder_ + "/none or " + folder_));
    write("12345");
    run(1s);
    EXPECT_TRUE(source_->condition().reopen) << "the file has come";
    fs::remove(folder_ + "/SN12345.conf");
    open(true);
    EXPECT_GT(run(1s), 0);
    EXPECT_FALSE(source_->info().calibration);
    EXPECT_THAT(source_->condition().notices, ElementsAre(HasSubstr("frames are unrectified")));
}

TEST_F(CameraCalibrationTest, ADamagedOrImplausibleFileIsNotUsed) {
    plug("12345");
    const std::pair<const char*, const char*> numbers[] = {{"120", "0.5"}, {"12,0", "0.01"}, {"-120", "0.01"}};
    for (const auto& [baseline, cv] : numbers) {
        write("12345", baseline, cv);
        open(true);
        EXPECT_EQ(run(1s), 0) << baseline << ' ' << cv;
        EXPECT_EQ(state(), CameraState::no_calibration);
        EXPECT_THAT(source_->condition().detail, HasSubstr("SN12345.conf"));
    }
}

TEST(CameraPlausibilityTest, EyesAreAlikeAndSideBySide) {
    calibration::StereoCalibration good;
    good.left.fx = good.right.fx = 500;
    good.translation = {-120, 0.5, 0.5};
    EXPECT_NO_THROW(calibration::check_camera_plausible(good));
    calibration::StereoCalibration bad = good;
    bad.right.fx = 600;
    EXPECT_THROW(calibration::check_camera_plausible(bad), std::invalid_argument);
    bad = good;
    bad.translation[1] = -30;
    EXPECT_THROW(calibration::check_camera_plausible(bad), std::invalid_argument);
    bad = good;
    bad.translation[2] = 30;
    EXPECT_THROW(calibration::check_camera_plausible(bad), std::invalid_argument);
}

TEST(CameraPlausibilityTest, NoFileNameOutsideOfTheFolders) {
    EXPECT_FALSE(calibration::find_camera_calibration("../../etc/passwd", {"/"}, 672, 376));
    EXPECT_THAT(calibration::folder_list(":/a::/b c:"), ElementsAre("/a", "/b c"));
}

TEST(ZedExtensionTest, SerialNumbersInFlash) {
    const auto serial = [](std::vector<std::uint8_t> bytes) { return zed_serial(bytes); };
    EXPECT_EQ(serial({'O', 'V', 0x10, 0x02, 0x80, 0x00, 0xff}), "10028000");
    EXPECT_EQ(serial({'O', 'V', 0x00, 0x00, 0x47, 0x11}), "4711");
    EXPECT_EQ(serial({'O', 'V', 0x00, 0x0a, 0x47, 0x11}), "");
    EXPECT_EQ(serial({'O', 'V', 0xff, 0xff, 0xff, 0xff}), "");
    EXPECT_EQ(serial({'O', 'V', 0x00, 0x00, 0x47}), "");
    EXPECT_EQ(serial({'X', 'V', 0x00, 0x00, 0x47, 0x11}), "");
    EXPECT_EQ(serial({}), "");
}

TEST(ZedExtensionTest, AnswersThatAreTooShortAreNone) {
    const std::vector<std::uint8_t> answer(20, 7);
    EXPECT_TRUE(zed_answer(answer, 3));
    EXPECT_FALSE(zed_answer(answer, 4));
    EXPECT_FALSE(zed_answer(std::span(answer).first(16), 0));
}

TEST(CameraSurveyTest, ModesAndWhatKeepsACameraFromBeingUsed) {
    FakeVideoSystem system;
    system.plug(zed2("/dev/video0", "OV0001")).flash_serial = "12345";
    system.plug(zed2("/dev/video2")).buffers_error = EBUSY;
    system.plug(zed2("/dev/video4")).open_error = EACCES;
    system.plug(zed2("/dev/video6")).usb.product = 0xf680;
    const auto list = survey_cameras(system);
    ASSERT_EQ(list.size(), 4U);
    EXPECT_EQ(list[0].camera.serial, "12345");
    EXPECT_EQ(list[0].problem, "");
    ASSERT_EQ(list[0].modes.size(), 1U);
    EXPECT_EQ(list[0].modes[0].format, "YUYV");
    EXPECT_EQ(list[0].modes[0].width, 64);
    EXPECT_THAT(list[0].modes[0].rates, ElementsAre(::testing::DoubleNear(30, 0.01)));
    EXPECT_THAT(list[1].problem, HasSubstr("in use by another program"));
    EXPECT_THAT(list[2].problem, HasSubstr("group video"));
    EXPECT_THAT(list[3].problem, HasSubstr("old firmware"));
    EXPECT_EQ(system.open_devices(), 0);
}

}  // namespace
}  // namespace disparityd::capture
