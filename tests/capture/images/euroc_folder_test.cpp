// SPDX-License-Identifier: Apache-2.0
//
// Folders of EuRoC and TUM-VI: pairs and times by data.csv, and the calibration beside them.
#include "capture/images/euroc_folder.h"

#include <cstdlib>
#include <filesystem>
#include <random>
#include <vector>

#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::capture {
namespace {

namespace fs = std::filesystem;

using calibration::test::camchain;
using calibration::test::euroc_sensor;
using calibration::test::Rig;
using calibration::test::with_other;
using test::refusal;
using test::TemporaryFolder;
using test::write_file;
using testing::HasSubstr;

constexpr const char* list_of_three =
    "#timestamp "
    "[ns],filename\r\n1520530308199447626,a.png\r\n1520530308249448034,b.png\r\n1520530308299448626,c.png\r\n";

/// mav0 with three images of 48 x 40 for each eye, whose names are no times.
class EurocFolder : public testing::Test {
protected:
    EurocFolder() {
        rig_.width = 48;
        rig_.height = 40;
        rig_.left = {40, 40, 24, 20};
        rig_.right = {40, 40.5, 23, 20.5};
        rig_.left_distortion = rig_.right_distortion = {-0.02, 0.003, 0.0001, -0.0002, 0};
        for (const int eye : {0, 1}) {
            fs::create_directories(camera(eye) + "/data");
            for (const char* name : {"a.png", "b.png", "c.png"}) {
                test::write_image(camera(eye) + "/data/" + name, test::numbered_image(48, 40, CV_8UC1, eye));
            }
            write_file(camera(eye) + "/data.csv", list_of_three);
            write_file(camera(eye) + "/sensor.yaml", euroc_sensor(rig_, eye));
        }
    }
    std::string camera(int eye) const { return folder_.file("mav0/cam" + std::to_string(eye)); }
    std::unique_ptr<FrameSource> open() const {
        SourceOptions options;
        options.uri = folder_.file("");
        options.pace = Pace::fastest;
        return open_source(options);
    }
    TemporaryFolder folder_;
    Rig rig_;
};

TEST_F(EurocFolder, TimesComeFromTheListAndTheCalibrationFromSensorYaml) {
    for (const std::string& name : {folder_.file(""), folder_.file("mav0")}) {
        const auto found = find_euroc(name);
        ASSERT_TRUE(found);
        ASSERT_EQ(found->frames.size(), 3U);
        EXPECT_EQ(found->frames[1].time_ns, 1520530308249448034);
        EXPECT_EQ(fs::path(found->frames[2].right).filename(), "c.png");
        EXPECT_TRUE(found->timed);
        EXPECT_EQ(found->unpaired, "");
    }
    const auto source = open();
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->right.cy, 20.5);
    EXPECT_NEAR(source->info().calibration->translation[0], -120, 1e-9);
    EXPECT_FALSE(find_euroc(camera(0)));
}

TEST_F(EurocFolder, ImagesOfOneEyeAreSkippedAndCounted) {
    write_file(camera(0) + "/data.csv", "1,a.png\n2,b.png\n3,c.png\n9,gone.png\n");
    write_file(camera(1) + "/data.csv", "1,a.png\n2,gone.png\n4,c.png\n9,gone.png\n");
    const auto found = find_euroc(folder_.file(""));
    ASSERT_TRUE(found);
    ASSERT_EQ(found->frames.size(), 1U);
    EXPECT_EQ(found->frames[0].time_ns, 1);
    EXPECT_THAT(found->unpaired, HasSubstr("1 pair; skipped are 2 images of the left eye alone, 1 of the right eye "
                                           "alone, and 1 time without an image"));
    write_file(camera(1) + "/data.csv", "5,a.png\n");
    EXPECT_THAT(refusal([&] { find_euroc(folder_.file("")); }), HasSubstr("mav0: found no two images"));
}

TEST_F(EurocFolder, ADamagedListIsRefusedInOneLine) {
    for (const auto& [line, said] : {std::pair("x,a.png", "data.csv:2: found 'x,a.png', expected the time in ns"),
                                     {"12", "data.csv:2: found '12'"},
                                     {"12,", "data.csv:2: found '12,'"},
                                     {"12,../a.png", "data.csv:2: found"},
                                     {"99999999999999999999,a.png", "data.csv:2: found"},
                                     {"9999999999999999999,a.png", "data.csv:2: found"},
                                     {"3,a.png\n3,b.png", "data.csv:3: found the time 3, expected more than 3"}}) {
        write_file(camera(1) + "/data.csv", std::string("#time\n") + line + "\n");
        EXPECT_THAT(refusal([&] { find_euroc(folder_.file("")); }), HasSubstr(said));
    }
}

TEST_F(EurocFolder, TumViHasItsCalibrationInDso) {
    fs::remove(camera(0) + "/sensor.yaml");
    EXPECT_EQ(find_euroc(folder_.file(""))->calibration, "");
    fs::create_directories(folder_.file("dso"));
    std::string chain = camchain(rig_);
    for (int eye = 0; eye < 2; ++eye) {
        chain = with_other(chain, "radtan", "equidistant");
    }
    write_file(folder_.file("dso/camchain.yaml"), chain);
    const auto source = open();
    ASSERT_TRUE(source->info().calibration);
    EXPECT_EQ(source->info().calibration->left.lens, calibration::LensModel::fisheye);
}

/// Damages a file in one of many ways: bytes changed, cut, doubled.
std::string damaged(std::string text, std::mt19937& random) {
    const auto place = [&] { return random() % text.size(); };
    for (std::uint32_t i = 0, count = 1 + random() % 4; i < count && !text.empty(); ++i) {
        switch (random() % 4) {
            case 0: text[place()] = static_cast<char>(random()); break;
            case 1: text.resize(place()); break;
            case 2: text.insert(place(), text.substr(place(), random() % 60)); break;
            default: text.erase(place(), random() % 20);
        }
    }
    return text;
}

TEST_F(EurocFolder, DamagedFilesGiveALineOrFrames) {
    std::mt19937 random(7);
    for (const auto& [file, text] :
         {std::pair("/data.csv", std::string(list_of_three)), {"/sensor.yaml", euroc_sensor(rig_, 0)}}) {
        int refused = 0;
        for (int i = 0; i < 300; ++i) {
            write_file(camera(0) + file, damaged(text, random));
            try {
                EXPECT_EQ(open()->info().eye_width, 48);
            } catch (const std::invalid_argument& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
                ++refused;
            }
        }
        EXPECT_GT(refused, 50) << file;
        write_file(camera(0) + file, text);
    }
}

TEST(EurocData, RealFoldersAreReadWithTheirCalibration) {
    const char* named = std::getenv("DISPARITYD_DATA");
    const fs::path folder = fs::path(named != nullptr ? named : DISPARITYD_DEFAULT_DATA) / "euroc";
    if (!fs::exists(folder / "mav0")) {
        GTEST_SKIP() << "no EuRoC images in " << folder << "; DISPARITYD_DATA names the folder";
    }
    SourceOptions options;
    options.uri = folder.string();
    options.pace = Pace::fastest;
    const auto source = open_source(options);
    ASSERT_TRUE(source->info().calibration);
    const auto& t = source->info().calibration->translation;
    EXPECT_NEAR(std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), 110.1, 0.1);
    EXPECT_EQ(find_euroc(options.uri)->frames.size(), 8U);
    // The sensor's axes are those of the body there, so that T_cam_imu leads back what T_BS of cam0 does.
    const calibration::InertialCalibration& inertial = source->info().calibration->inertial;
    ASSERT_TRUE(inertial.to_left_camera);
    const calibration::Pose back = calibration::inverse(*inertial.to_left_camera);
    EXPECT_NEAR(back.translation[0], -21.64, 0.01);
    EXPECT_NEAR(back.translation[1], -64.68, 0.01);
    EXPECT_NEAR(back.translation[2], 9.81, 0.01);
    EXPECT_NEAR(back.rotation[3], 0.99956, 1e-5);
    EXPECT_EQ(inertial.gyroscope_noise_density, 1.6968e-4);
    EXPECT_EQ(inertial.gyroscope_random_walk, 1.9393e-5);
    EXPECT_EQ(inertial.accelerometer_noise_density, 2e-3);
    EXPECT_EQ(inertial.accelerometer_random_walk, 3e-3);
    EXPECT_FALSE(inertial.time_offset_s);
    const auto fisheye = calibration::read_calibration((folder / "fisheye/left_sensor_fisheye.yaml").string() + "," +
                                                           (folder / "fisheye/right_sensor_fisheye.yaml").string(),
                                                       752, 480);
    EXPECT_EQ(fisheye.right.lens, calibration::LensModel::fisheye);
}

}  // namespace
}  // namespace disparityd::capture
