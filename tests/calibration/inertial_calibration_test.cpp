// SPDX-License-Identifier: Apache-2.0
//
// Where the inertial sensor stands to the cameras, when its samples are, and how exact it is: from every file that says
// so. The sensor here has x up, y to the left, z back; it stands 20 mm to the left of the left camera, 10 mm above it.
#include "calibration/inertial_calibration.h"

#include "calibration/calibration.h"
#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using test::camchain;
using test::opencv_text;
using test::Rig;
using test::with_other;
using testing::HasSubstr;

/// By hand: up is -y of the camera, left is -x, back is -z.
const Pose standing{{0, -1, 0, -1, 0, 0, 0, 0, -1}, {-20, -10, 0}};

/// Is left-handed: x up, y left, z ahead.
const std::array<double, 9> mirroring{0, -1, 0, -1, 0, 0, 0, 0, 1};

InertialCalibration known() {
    return {standing, -0.0025, 1.6968e-4, 1.9393e-5, 2e-3, 3e-3};
}

StereoCalibration pair_of(const Rig& rig) {
    StereoCalibration pair;
    pair.width = rig.width;
    pair.height = rig.height;
    pair.left = {rig.left[0], rig.left[1], rig.left[2], rig.left[3], {}};
    pair.right = {rig.right[0], rig.right[1], rig.right[2], rig.right[3], {}};
    pair.translation = {-120, 0, 0};
    return pair;
}

class InertialFiles : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        write_file(folder_.file(name), text);
        return folder_.file(name);
    }
    static InertialCalibration read(const std::string& name) {
        return read_calibration(name, Rig().width, Rig().height).inertial;
    }
    static std::string said_of(const std::string& name) {
        return refusal([&] { read(name); });
    }
    static void expect_standing(const std::optional<Pose>& found) {
        ASSERT_TRUE(found);
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_NEAR(found->rotation[i], standing.rotation[i], 1e-9);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(found->translation[i], standing.translation[i], 1e-9);
        }
    }
    TemporaryFolder folder_;
};

const std::string chain_pose =
    "  T_cam_imu:\n  - [0, -1, 0, -0.02]\n  - [-1, 0, 0, -0.01]\n  - [0, 0, -1, 0]\n"
    "  - [0, 0, 0, 1]\n";

TEST(Pose, LeadsThereAndBack) {
    const Pose turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 2, 3}};  // x to y, y to -x
    EXPECT_EQ(chained(Pose(), turned), turned);
    EXPECT_EQ(chained(turned, inverse(turned)), Pose());
    // Back: (4, 5, 6) - (1, 2, 3) = (3, 3, 3); what lies at y comes from x, what lies at x from -y.
    const Pose back = chained({{1, 0, 0, 0, 1, 0, 0, 0, 1}, {4, 5, 6}}, inverse(turned));
    EXPECT_EQ(back.translation, (std::array<double, 3>{3, -3, 3}));
}

TEST(InertialText, ComesBackToTheBit) {
    StereoCalibration pair = pair_of(Rig());
    const std::string without = to_text(pair);
    EXPECT_EQ(without.find("imu"), std::string::npos);
    EXPECT_EQ(calibration_from_text(without, "recording").inertial, InertialCalibration());
    pair.inertial = known();
    EXPECT_EQ(calibration_from_text(to_text(pair), "recording").inertial, known());
    pair.inertial = {{}, {}, {}, {}, 1e-3, {}};
    EXPECT_EQ(calibration_from_text(to_text(pair), "recording").inertial, pair.inertial);
}

TEST(InertialText, ContradictionsAreRefused) {
    const auto said = [](const InertialCalibration& inertial) {
        StereoCalibration pair = pair_of(Rig());
        pair.inertial = inertial;
        return refusal([&] { calibration_from_text(to_text(pair), "recording"); });
    };
    EXPECT_THAT(said({Pose{mirroring, {}}, {}, {}, {}, {}, {}}), HasSubstr("T_cam_imu: the matrix that turns"));
    EXPECT_THAT(said({Pose{{}, {0, 0, 200000}}, {}, {}, {}, {}, {}}), HasSubstr("is no rotation"));
    EXPECT_THAT(said({Pose{standing.rotation, {0, 0, 200000}}, {}, {}, {}, {}, {}}), HasSubstr("found an inertial"));
    EXPECT_THAT(said({{}, 61, {}, {}, {}, {}}), HasSubstr("timeshift_cam_imu: found 61, allowed is -60 to 60 s"));
    EXPECT_THAT(said({{}, {}, 0, {}, {}, {}}), HasSubstr("gyroscope_noise_density: found 0, allowed is more than 0"));
    EXPECT_THAT(said({{}, {}, {}, -1, {}, {}}), HasSubstr("gyroscope_random_walk: found -1"));
}

TEST_F(InertialFiles, OurOwnFileHasAllOfIt) {
    StereoCalibration pair = pair_of(Rig());
    pair.inertial = known();
    const std::string text = to_opencv_yaml(pair);
    EXPECT_EQ(read(write("own.yml", text)), known());
    EXPECT_EQ(read(write("own.yml", to_opencv_yaml(pair_of(Rig())))), InertialCalibration());
    EXPECT_THAT(said_of(write("own.yml", with_other(text, "timeshift_cam_imu: -0.0025", "timeshift_cam_imu: soon"))),
                HasSubstr("timeshift_cam_imu: found 'soon', expected a number"));
    EXPECT_THAT(said_of(write("own.yml", text + "T_cam_imu2: 1\n")), HasSubstr("'T_cam_imu2'"));
    pair.inertial.to_left_camera->rotation = mirroring;
    EXPECT_THAT(said_of(write("own.yml", to_opencv_yaml(pair))), HasSubstr("own.yml: T_cam_imu: the matrix"));
}

TEST_F(InertialFiles, LengthsOfAnOpenCvFileHaveItsUnit) {
    const std::string pose = "T_cam_imu: [[0, -1, 0, -0.02], [-1, 0, 0, -0.01], [0, 0, -1, 0], [0, 0, 0, 1]]\n";
    Rig metres;
    metres.translation = {-0.12, 0.0009, -0.0006};
    expect_standing(read(write("stereo.yml", opencv_text(metres) + pose) + "?unit=m").to_left_camera);
    expect_standing(read(write("stereo.yml", opencv_text(metres) + pose + "unit: m\n")).to_left_camera);
    EXPECT_THAT(said_of(write("stereo.yml", opencv_text(Rig()) + with_other(pose, "[0, 0, 0, 1]", "[0, 0, 1, 1]"))),
                HasSubstr("T_cam_imu: expected a matrix of 4x4"));
}

TEST_F(InertialFiles, KalibrsCamchainOfCamerasAndSensor) {
    const std::string text = camchain(Rig());
    EXPECT_EQ(read(write("chain.yaml", text)), InertialCalibration());
    const std::string left = with_other(text, "cam0:\n", "cam0:\n" + chain_pose + "  timeshift_cam_imu: 0.004\n");
    const InertialCalibration found = read(write("chain.yaml", left));
    expect_standing(found.to_left_camera);
    EXPECT_EQ(found.time_offset_s, 0.004);
    EXPECT_FALSE(found.gyroscope_noise_density);
    EXPECT_THAT(said_of(write("chain.yaml", with_other(left, "[0, 0, -1, 0]", "[0, 0, 1, 0]"))),
                HasSubstr("cam0 T_cam_imu: is no pose"));
    EXPECT_THAT(said_of(write("chain.yaml", with_other(left, ": 0.004", ": [1]"))),
                HasSubstr("cam0 timeshift_cam_imu: found '', expected a number"));
}

const std::string kalibr_imu =
    "#Accelerometers\naccelerometer_noise_density: 0.0014   # continuous\n"
    "accelerometer_random_walk: 8.6e-05\ngyroscope_noise_density: 8.0e-05\n"
    "gyroscope_random_walk: 2.2e-06\nrostopic: /imu0\nupdate_rate: 200.0\n";

TEST_F(InertialFiles, KalibrsNoiseStandsInAFileOfItsOwn) {
    const std::string chain = write("chain.yaml", with_other(camchain(Rig()), "cam0:\n", "cam0:\n" + chain_pose));
    const InertialCalibration expected{standing, {}, 8e-5, 2.2e-6, 1.4e-3, 8.6e-5};
    EXPECT_EQ(read(chain + "," + write("imu.yaml", kalibr_imu)), expected);
    std::string nested =
        "imu0:\n  T_i_b:\n  - [1.0, 0.0, 0.0, 0.0]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
        "  - [0.0, 0.0, 0.0, 1.0]\n  accelerometer_noise_density: 0.0014\n"
        "  accelerometer_random_walk: 8.6e-05\n  gyroscope_noise_density: 8.0e-05\n"
        "  gyroscope_random_walk: 2.2e-06\n  model: calibrated\n  rostopic: /imu0\n"
        "  time_offset: 0.0\n  update_rate: 200.0\n";
    EXPECT_EQ(read(chain + "," + write("imu.yaml", nested)), expected);
    EXPECT_THAT(said_of(chain + "," + write("imu.yaml", nested + "imu1:\n  model: calibrated\n")),
                HasSubstr("has more than the entries of imu0"));
    for (const auto& [from, to, said] :
         {std::tuple("time_offset: 0.0", "time_offset: 0.1", "time_offset: found another one than 0"),
          {"[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0, 0.5]", "T_i_b: found another pose"},
          {"calibrated", "scale-misalignment", "model: found 'scale-misalignment', expected calibrated"},
          {"rostopic", "M", "has the key 'M'"},
          {"8.0e-05", "much", "gyroscope_noise_density: found 'much', expected a number"},
          {"8.0e-05", "0", "gyroscope_noise_density: found 0, allowed is more than 0"}}) {
        EXPECT_THAT(said_of(chain + "," + write("imu.yaml", with_other(nested, from, to))), HasSubstr(said));
    }
    EXPECT_THAT(said_of(write("imu.yaml", kalibr_imu)), HasSubstr("is about an inertial sensor alone"));
    EXPECT_THAT(said_of(chain + "," + chain), HasSubstr("is Kalibr's camchain, and"));
}

TEST_F(InertialFiles, NoiseMayStandBesideAnyFileAndMustAgreeWithIt) {
    StereoCalibration pair = pair_of(Rig());
    pair.inertial = known();
    const std::string own = write("own.yml", to_opencv_yaml(pair));
    const std::string said = said_of(own + "," + write("imu.yaml", kalibr_imu));
    EXPECT_THAT(said, HasSubstr("imu.yaml: gyroscope_noise_density: found 8e-05"));
    EXPECT_THAT(said, HasSubstr("they contradict each other"));
    pair.inertial = {};
    EXPECT_EQ(read(write("own.yml", to_opencv_yaml(pair)) + "," + write("imu.yaml", kalibr_imu)).gyroscope_random_walk,
              2.2e-6);
}

/// sensor.yaml of a sensor whose axes are those of the body, turned about z by 90 degrees and moved: x of the sensor is
/// y of the body.
const std::string euroc_imu =
    "%YAML:1.0\n#Default\nsensor_type: imu\ncomment: made\nT_BS:\n  cols: 4\n  rows: 4\n"
    "  data: [0.0, -1.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.2, 0.0, 0.0, 1.0, 0.3, 0.0, 0.0, 0.0, 1.0]\n"
    "rate_hz: 200\ngyroscope_noise_density: 1.6968e-04 # [ rad / s / sqrt(Hz) ]\n";

TEST_F(InertialFiles, EurocsSensorStandsOnTheBodyOfTheCameras) {
    // By hand: the left camera lies at (0.5, 0, 0) of the body, its x is the body's z, its y is -y, its z is x.
    const auto camera = [](const char* shift) {
        return std::string("sensor_type: camera\nT_BS: [0, 0, 1, 0.5, 0, -1, 0, 0, 1, 0, 0, ") + shift +
               ", 0, 0, 0, 1]\nresolution: [640, 480]\ncamera_model: pinhole\nintrinsics: [500, 500, 320, 240]\n"
               "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n";
    };
    const std::string pair = write("left.yaml", camera("0")) + "," + write("right.yaml", camera("0.12"));
    const InertialCalibration found = read(pair + "," + write("imu.yaml", euroc_imu));
    ASSERT_TRUE(found.to_left_camera);
    // The sensor's x is the body's y, so -y of the camera; its y is -x of the body, so -z; its z is z, so x.
    EXPECT_EQ(found.to_left_camera->rotation, (std::array<double, 9>{0, 0, 1, -1, 0, 0, 0, -1, 0}));
    // From the camera to the sensor is (-0.4, 0.2, 0.3) on the body: x 300, y -200, z -400 mm.
    EXPECT_NEAR(found.to_left_camera->translation[0], 300, 1e-9);
    EXPECT_NEAR(found.to_left_camera->translation[1], -200, 1e-9);
    EXPECT_NEAR(found.to_left_camera->translation[2], -400, 1e-9);
    EXPECT_EQ(found.gyroscope_noise_density, 1.6968e-4);
    EXPECT_FALSE(found.accelerometer_noise_density);
    EXPECT_FALSE(found.time_offset_s);
    EXPECT_EQ(read(pair), InertialCalibration());
    EXPECT_THAT(said_of(pair + "," + write("imu.yaml", with_other(euroc_imu, "[0.0, -1.0", "[0.0, 1.0"))),
                HasSubstr("imu.yaml: T_BS: is no pose"));
    EXPECT_THAT(said_of(pair + "," + folder_.file("left.yaml")), HasSubstr("left.yaml: is the third file"));
    EXPECT_THAT(said_of(write("chain.yaml", camchain(Rig())) + "," + write("imu.yaml", euroc_imu)),
                HasSubstr("T_BS: says where the sensor stands on a body"));
}

TEST_F(InertialFiles, KalibrsCamchainMaySayItOfTheRightCameraAlone) {
    Rig rig;
    rig.turn = {0, 0, 0};
    rig.translation = {-120, 0, 0};
    // From the right camera, 120 mm to the right, the sensor stands 140 mm to the left.
    const std::string right = with_other(chain_pose, "-0.02]", "-0.14]");
    expect_standing(read(write("chain.yaml", with_other(camchain(rig), "cam1:\n", "cam1:\n" + right))).to_left_camera);
}

}  // namespace
}  // namespace disparityd::calibration
