// SPDX-License-Identifier: Apache-2.0
//
// The same pairs of cameras in every format, against OpenCV's own rectification of them; and what must not be read.
#include "calibration/calibration.h"
#include "calibration/calibration_lookup.h"
#include "calibration/rectification.h"
#include "calibration/rectified_camera.h"
#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using test::calibration_of;
using test::camchain;
using test::list_of;
using test::matrix_text;
using test::opencv_text;
using test::orbslam_2;
using test::orbslam_3;
using test::python_text;
using test::Rectified;
using test::Rig;
using test::rigs;
using test::ros_message;
using test::ros_text;
using test::row;
using test::size_lines;
using test::with_other;
using test::write_by_opencv;
using testing::AllOf;
using testing::HasSubstr;

class Formats : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        write_file(folder_.file(name), text);
        return folder_.file(name);
    }
    /// What reading it for the rig's images says.
    std::string refused(const std::string& text, const Rig& rig = Rig(), const std::string& name = "stereo.yml") const {
        const std::string path = write(name, text);
        return refusal([&] { read_calibration(path, rig.width, rig.height); });
    }
    /// Reads the file and compares with the rig's own rectification.
    static void expect_rig(const std::string& path, const Rig& rig, double tolerance = 1e-6) {
        const StereoCalibration read = read_calibration(path, rig.width, rig.height);
        const Rectification ours = make_rectification(read, rig.width, rig.height, {});
        const Rectified expected(rig);
        const double f = rectified_camera(calibration_of(rig), rig.width, rig.height).f;
        EXPECT_NEAR(ours.f, f, tolerance * f) << path;
        EXPECT_NEAR(ours.baseline_mm, expected.baseline(), tolerance * expected.baseline()) << path;
        EXPECT_NEAR(read.left.distortion[0], rig.left_distortion[0], 1e-12) << path;
        EXPECT_NEAR(read.right.distortion[3], rig.right_distortion[3], 1e-12) << path;
        EXPECT_NEAR(read.right.cy, rig.right[3], 1e-9) << path;
        for (std::size_t i = 0; i < 9; ++i) {
            EXPECT_NEAR(read.rotation[i], rig.rotation().val[i], 1e-6) << path;
        }
    }
    TemporaryFolder folder_;
};

TEST_F(Formats, OpenCvWithAndWithoutItsFirstLine) {
    for (const Rig& rig : rigs()) {
        for (const char* head : {"", "%YAML:1.0\n---\n", "%YAML 1.2\n---\n", "# by hand\n", "---\n"}) {
            expect_rig(write("stereo.yml", head + opencv_text(rig)), rig);
        }
    }
}

TEST_F(Formats, TheVendorsOwnNamesAsOpenCvWritesThem) {
    for (const Rig& rig : rigs()) {
        for (const char* name : {"zed_calibration_123.yml", "stereo.json", "stereo.xml"}) {
            write_by_opencv(rig, folder_.file(name));
            expect_rig(folder_.file(name), rig);
        }
        const auto found = find_camera_calibration("123", {folder_.file("")}, rig.width, rig.height);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->translation[0], rig.translation[0], 1e-9);
    }
}

TEST_F(Formats, RosPairWhateverPointTheProjectionsAreSeenFrom) {
    for (const Rig& rig : rigs()) {
        const double baseline = Rectified(rig).baseline();
        for (const double left_shift : {0.0, 59.9, -1.5}) {
            for (const char* head : {"", "%YAML:1.0\n---\n"}) {
                const std::string left = write("left.yaml", head + ros_text(rig, 0, left_shift));
                const std::string right = write("right.yaml", head + ros_text(rig, 1, left_shift - baseline));
                expect_rig(left + "," + right, rig);
            }
        }
    }
}

TEST_F(Formats, RosMessagesAsText) {
    for (const Rig& rig : rigs()) {
        const double baseline = Rectified(rig).baseline();
        const auto pair = [&](bool lower_case, const std::string& more) {
            return write("left.txt", ros_message(rig, 0, 1.5, lower_case, more)) + "," +
                   write("right.txt", ros_message(rig, 1, 1.5 - baseline, lower_case));
        };
        const auto said = [&](const std::string& more) {
            const std::string name = pair(false, more);
            return refusal([&] { read_calibration(name, rig.width, rig.height); });
        };
        const std::string whole = "binning_x: 1\nbinning_y: 0\nroi:\n  x_offset: 0\n  y_offset: 0\n  height: 0\n";
        expect_rig(pair(false, whole), rig);
        expect_rig(pair(true, whole), rig);
        EXPECT_THAT(said("binning_y: 2\n"), HasSubstr("left.txt: binning_y: found 2, expected 0 or 1"));
        EXPECT_THAT(said("roi:\n  x_offset: 64\n"), HasSubstr("roi x_offset: found 64, expected 0:"));
        EXPECT_THAT(said("roi:\n  width: 64\n"),
                    HasSubstr("roi width: found 64, expected 0 or " + std::to_string(rig.width)));
        expect_rig(pair(false, "roi:\n  width: " + std::to_string(rig.width) + "\n"), rig);
        EXPECT_THAT(said("camera_matrix: [1]\n"), HasSubstr("K and camera_matrix are two names of the same"));
        EXPECT_THAT(said("xi: 1\n"), HasSubstr("'xi'"));
    }
}

TEST_F(Formats, RosMessagesAsJson) {
    const Rig rig;
    std::string name;
    for (const int eye : {0, 1}) {
        std::string text = ros_message(rig, eye, eye == 0 ? 0 : -Rectified(rig).baseline(), false);
        text = with_other(text.substr(text.find("height")), "plumb_bob", "\"plumb_bob\"");
        text.resize(text.rfind("---"));
        std::string json = "{";
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            const auto colon = line.find(':');
            json += (json.size() == 1 ? "\"" : ", \"") + line.substr(0, colon) + "\"" + line.substr(colon);
        }
        name += (eye == 0 ? "" : ",") + write(eye == 0 ? "left.json" : "right.json", json + "}\n");
    }
    expect_rig(name, rig);
}

TEST_F(Formats, ARosMatrixOfAnotherShapeThanItsNumbers) {
    const std::string left = write("left.yaml", with_other(ros_text(Rig(), 0, 0), "cols: 5", "cols: 8"));
    const std::string right = write("right.yaml", ros_text(Rig(), 1, -120));
    EXPECT_THAT(refusal([&] { read_calibration(left + "," + right, 640, 480); }),
                HasSubstr("distortion_coefficients: found 1 rows and 8 columns, and 5 numbers"));
}

TEST_F(Formats, MatricesAsListsOfRows) {
    for (const Rig& rig : rigs()) {
        expect_rig(write("stereo.yaml", python_text(rig, false)), rig);
        expect_rig(write("stereo.json", python_text(rig, true)), rig);
    }
    const std::string text = python_text(Rig(), false);
    EXPECT_THAT(refused(with_other(text, "- [0, 0, 1]\n", "- [0, 1]\n")),
                AllOf(HasSubstr("cameraMatrix1"), HasSubstr("3 columns, and 8 numbers")));
    EXPECT_THAT(refused(with_other(text, "R:\n", "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nE:\n")), HasSubstr("R: found 1x9"));
}

// As KITTI's colour pair has it: both eyes are seen from a third camera.
TEST_F(Formats, OrbSlamWithAShiftOfTheLeftEye) {
    for (const Rig& rig : rigs()) {
        const Rectified rectified(rig);
        for (const double shift : {44.857, -3.5}) {
            std::string text = orbslam_2(rig);
            for (const int eye : {0, 1}) {
                cv::Mat projection = rectified.projection[eye].clone();
                projection.at<double>(0, 3) /= 1000;
                const std::string old = list_of(projection);
                projection.at<double>(0, 3) += shift;
                text = with_other(text, old, list_of(projection));
            }
            expect_rig(write("settings.yaml", text), rig);
        }
    }
}

TEST_F(Formats, OrbSlamAndKalibr) {
    for (Rig rig : rigs()) {
        expect_rig(write("EuRoC.yaml", orbslam_2(rig)), rig);
        expect_rig(write("EuRoC.yaml", orbslam_3(rig)), rig);
        rig.left_distortion[4] = rig.right_distortion[4] = 0;
        expect_rig(write("camchain.yaml", camchain(rig)), rig);
    }
}

TEST_F(Formats, EurocSensorsOfBothCameras) {
    const auto said_of = [](const std::string& name, int width, int height) {
        return refusal([&] { read_calibration(name, width, height); });
    };
    for (Rig rig : rigs()) {
        rig.left_distortion[4] = rig.right_distortion[4] = 0;
        const std::string left = write("left.yaml", euroc_sensor(rig, 0));
        const std::string right = write("right.yaml", euroc_sensor(rig, 1));
        expect_rig(left + "," + right, rig);
        EXPECT_THAT(said_of(left + "," + right, 320, 200), HasSubstr("(resolution)"));
        EXPECT_THAT(said_of(right + "," + left, rig.width, rig.height), HasSubstr("lies left of the left one"));
        EXPECT_THAT(said_of(left, rig.width, rig.height),
                    HasSubstr("found EuRoC's sensor.yaml of one camera; name both"));
    }
    const Rig rig;
    const std::string right = "," + write("right.yaml", euroc_sensor(rig, 1));
    for (const auto& [from, to, said] :
         {std::tuple("sensor_type: camera", "sensor_type: imu", "sensor_type: found 'imu', expected camera"),
          {"radial-tangential", "omni", "distortion_model: found 'omni'"},
          {"rate_hz", "shutter", "has the key 'shutter'"},
          {"0, 0, 0, 1]", "0, 0, 0, 2]", "T_BS: is no pose"},
          {"0, 0, 0, 1]", "0, 0, 1]", "T_BS: expected 16 numbers"}}) {
        EXPECT_THAT(said_of(write("left.yaml", with_other(euroc_sensor(rig, 0), from, to)) + right, 640, 480),
                    HasSubstr(said));
    }
}

TEST_F(Formats, RationalThinPrismAndTiltedLensesAreRead) {
    const Rig rig;
    const std::string text = opencv_text(rig);
    for (const int count : {8, 12, 14}) {
        cv::Mat longer = cv::Mat::zeros(1, count, CV_64F);
        row(rig.left_distortion).copyTo(longer.colRange(0, 5));
        const std::string five = matrix_text("D1", row(rig.left_distortion));
        expect_rig(write("stereo.yml", with_other(text, five, matrix_text("D1", longer))), rig);
        longer.at<double>(0, count - 1) = 0.003;
        const StereoCalibration read = read_calibration(
            write("stereo.yml", with_other(text, five, matrix_text("D1", longer))), rig.width, rig.height);
        EXPECT_EQ(read.left.distortion[static_cast<std::size_t>(count) - 1], 0.003);
        EXPECT_EQ(read.left.lens, LensModel::pinhole);
        EXPECT_EQ(to_text(calibration_from_text(to_text(read), "test")), to_text(read));
        const StereoCalibration again = read_calibration(write("again.yml", to_opencv_yaml(read)), 640, 480);
        EXPECT_EQ(again.left.distortion, read.left.distortion);
    }
    const std::string nine = matrix_text("D1", cv::Mat::ones(1, 9, CV_64F) * 0.001);
    EXPECT_THAT(refused(with_other(text, matrix_text("D1", row(rig.left_distortion)), nine)),
                HasSubstr("D1: found 9 distortion coefficients"));
}

TEST_F(Formats, FisheyeLensesAreReadFromEveryFormatThatNamesThem) {
    Rig rig;
    rig.left_distortion = {-0.0387, 0.0305, -0.0238, 0.0168, 0};
    rig.right_distortion = {-0.0351, 0.0215, -0.0102, 0.0044, 0};
    const std::array<double, 14> expected{-0.0387, 0.0305, -0.0238, 0.0168};
    const auto expect_fisheye = [&](const std::string& name) {
        const StereoCalibration read = read_calibration(name, rig.width, rig.height);
        for (const CameraModel* camera : {&read.left, &read.right}) {
            EXPECT_EQ(camera->lens, LensModel::fisheye) << name;
        }
        EXPECT_EQ(read.left.distortion, expected) << name;
        EXPECT_EQ(read.right.distortion[3], 0.0044) << name;
        EXPECT_EQ(make_rectification(read, rig.width, rig.height, {}).f, rig.left[1]) << name;
        EXPECT_EQ(to_text(calibration_from_text(to_text(read), "test")), to_text(read));
        const StereoCalibration again = read_calibration(write("again.yml", to_opencv_yaml(read)), 640, 480);
        EXPECT_EQ(again.left.lens, LensModel::fisheye);
        EXPECT_EQ(again.left.distortion, expected);
    };
    std::string text = opencv_text(rig);
    std::string ros[2] = {ros_text(rig, 0, 0), ros_text(rig, 1, -Rectified(rig).baseline())};
    for (const int eye : {0, 1}) {
        const auto& five = eye == 0 ? rig.left_distortion : rig.right_distortion;
        const cv::Mat four = row(five).colRange(0, 4).clone();
        const std::string name = eye == 0 ? "D1" : "D2";
        text = with_other(text, matrix_text(name, row(five)), matrix_text(name, four));
        ros[eye] = with_other(with_other(ros[eye], matrix_text("distortion_coefficients", row(five)),
                                         matrix_text("distortion_coefficients", four)),
                              "plumb_bob", "equidistant");
    }
    for (const char* line :
         {"distortion_model: equidistant\n", "camera_model: Kannala-Brandt\n", "fisheye_model: 1\n"}) {
        expect_fisheye(write("stereo.yml", line + text));
    }
    expect_fisheye(write("stereo.yml", text) + "?model=fisheye");
    const std::string left = write("left.yaml", ros[0]);
    expect_fisheye(left + "," + write("right.yaml", ros[1]));
    const std::string chain = with_other(camchain(rig), "radtan", "equidistant");
    expect_fisheye(write("camchain.yaml", with_other(chain, "radtan", "equidistant")));
    std::string slam = with_other(orbslam_3(rig), "PinHole", "KannalaBrandt8");
    for (int eye = 0; eye < 2; ++eye) {
        slam = with_other(slam, std::string("Camera") + (eye == 0 ? "1" : "2") + ".k3",
                          std::string("Ignored.k") + std::to_string(eye));
    }
    for (const char* camera : {"Camera1.", "Camera2."}) {
        slam = with_other(slam, std::string(camera) + "p1", std::string(camera) + "k3");
        slam = with_other(slam, std::string(camera) + "p2", std::string(camera) + "k4");
    }
    expect_fisheye(write("slam.yaml", slam));
}

TEST_F(Formats, ALensModelThatIsNotAppliedIsRefusedByItsName) {
    const Rig rig;
    EXPECT_THAT(refused("distortion_model: omni\n" + opencv_text(rig)), HasSubstr("found 'omni'"));
    EXPECT_THAT(refused("distortion_model: equidistant\n" + opencv_text(rig)),
                HasSubstr("D1: found 5 distortion coefficients, expected the 4 of a fisheye lens"));
    EXPECT_THAT(refused("fisheye_model: 3\n" + opencv_text(rig)), HasSubstr("looks like the fisheye model"));
    EXPECT_THAT(refused(with_other(camchain(rig), "pinhole", "ds")), HasSubstr("cam0 camera_model: found 'ds'"));
    EXPECT_THAT(refused(with_other(orbslam_3(rig), "PinHole", "KannalaBrandt8")), HasSubstr("Camera1.p1"));
}

TEST_F(Formats, FourCoefficientsMayBeThoseOfAFisheye) {
    const Rig rig;
    std::string text = opencv_text(rig);
    for (const char* name : {"D1", "D2"}) {
        const auto& five = name == std::string("D1") ? rig.left_distortion : rig.right_distortion;
        text = with_other(text, matrix_text(name, row(five)), matrix_text(name, row(five).colRange(0, 4).clone()));
    }
    EXPECT_THAT(refused(text),
                AllOf(HasSubstr("D1: found 4 coefficients"), HasSubstr("?model=brown or ?model=fisheye")));
    const StereoCalibration read = read_calibration(write("stereo.yml", text) + "?model=brown", rig.width, rig.height);
    EXPECT_EQ(read.left.distortion[3], rig.left_distortion[3]);
    EXPECT_EQ(read_calibration(write("stereo.yml", "distortion_model: radtan\n" + text), rig.width, rig.height)
                  .left.distortion[4],
              0);
}

TEST_F(Formats, NothingIsIgnored) {
    const Rig rig;
    const std::string text = opencv_text(rig);
    EXPECT_THAT(refused("xi: 1.5\n" + text), AllOf(HasSubstr("'xi'"), HasSubstr("'1.5'")));
    EXPECT_THAT(refused("M1: 3\n" + text), HasSubstr("the key 'M1' twice"));
    EXPECT_THAT(refused("baseline: 60\n" + text), AllOf(HasSubstr("baseline: found '60'"), HasSubstr("contradict")));
    const std::string other = matrix_text("cameraMatrix1", cv::Mat(rig.right_matrix()));
    EXPECT_THAT(refused(other + text), AllOf(HasSubstr("M1"), HasSubstr("cameraMatrix1"), HasSubstr("two names")));
    cv::Matx33d skewed = rig.left_matrix();
    skewed(0, 1) = 1.25;
    EXPECT_THAT(refused(with_other(text, list_of(cv::Mat(rig.left_matrix())), list_of(cv::Mat(skewed)))),
                HasSubstr("M1: found a skew of 1.25 px"));
    EXPECT_THAT(refused(with_other(text, "0, 0, 1 ]", "0, 1 ]")), AllOf(HasSubstr("M1"), HasSubstr("8 numbers")));
    EXPECT_THAT(refused(std::string(5000, 'x') + ": 1\n" + text), testing::SizeIs(testing::Lt(700U)));
    for (const char* key : {"H1", "map11", "stereoMapL_x", "left_map_y"}) {
        for (const std::string& file : {text, std::string()}) {
            EXPECT_THAT(refused(matrix_text(key, cv::Mat::eye(2, 2, CV_64F)) + file),
                        AllOf(HasSubstr(std::string(key) + ": found a matrix, which says how pixels move"),
                              HasSubstr("take it out")));
        }
    }
    EXPECT_THAT(refused("%YAML:1.0\n---\n" + text + "---\nxi: 1.5\n"), HasSubstr("several documents"));
    // A library that reads all documents finds one after the other here, for ever.
    EXPECT_THAT(refused("%YAML:1.0\n---\n,\n"), HasSubstr("damaged"));
    // Ten lists of ten lists of ten lists ...
    std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
    for (int i = 1; i < 12; ++i) {
        const std::string before = "*a" + std::to_string(i - 1);
        bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
        for (int j = 1; j < 10; ++j) {
            bomb += ", " + before;
        }
        bomb += "]\n";
    }
    EXPECT_THAT(refused("%YAML:1.0\n---\n" + bomb + text), HasSubstr("'a0'"));
    // What says nothing about the geometry is taken.
    expect_rig(write("stereo.yml", "%YAML:1.0\n---\n# ends as messages of ROS do\n" + text + "---\n"), rig);
    expect_rig(write("stereo.yml", "rms: 0.2\nsquare_size: 25\nboard_width: 9\ncalibration_time: now\n" + text), rig);
}

TEST_F(Formats, TheSizeUnderEveryUsualKeyIsCompared) {
    const Rig rig;
    const std::string text = with_other(opencv_text(rig), size_lines(rig), "");
    for (const char* size :
         {"image_size: [ 1280, 960 ]\n", "Size: [1280, 960]\n", "imageSize: [ 1280, 960 ]\n",
          "resolution: [ 1280, 960 ]\n", "img_shape: [ 960, 1280 ]\n", "frame_width: 1280\nframe_height: 960\n",
          "imageWidth: 1280\nimageHeight: 960\n", "resolution: 1280x960\n", "image_size: \"1280, 960\"\n",
          "size:\n  rows: 1\n  cols: 2\n  dt: i\n  data: [ 1280, 960 ]\n"}) {
        EXPECT_THAT(refused(size + text), AllOf(HasSubstr("1280x960"), HasSubstr("640x480"))) << size;
    }
    EXPECT_THAT(refused("image_width: 1280\n" + text), AllOf(HasSubstr("1280"), HasSubstr("640x480")));
    expect_rig(write("stereo.yml", "img_shape: [ 480, 640, 3 ]\n" + text), rig);
    expect_rig(write("stereo.yml", "resolution: 640 x 480\n" + text), rig);
    EXPECT_THAT(refused("resolution: HD720\n" + text),
                HasSubstr("resolution: found 'HD720', expected width and height"));
    expect_rig(write("stereo.yml", text), rig);
    // Without any, the principal points tell a file for images of twice the size.
    const std::string path = write("stereo.yml", text);
    EXPECT_THAT(refusal([&] { read_calibration(path, 1280, 960); }), HasSubstr("does not say for which size"));
}

TEST_F(Formats, UnitsAreAskedFor) {
    for (const Rig& rig : {rigs()[0], rigs()[2]}) {
        for (const auto& [unit, name] : {std::pair(1000.0, "m"), {10.0, "cm"}, {25.0, "25mm"}, {30.5, "30.5mm"}}) {
            const std::string text = opencv_text(rig, unit);
            expect_rig(write("stereo.yml", text) + "?unit=" + name, rig);
            expect_rig(write("stereo.yml", "unit: " + std::string(name) + "\n" + text), rig);
            if (-rig.translation[0] / unit < 17) {
                EXPECT_THAT(refused(text, rig), AllOf(HasSubstr("the baseline"), HasSubstr("?unit=m ("),
                                                      HasSubstr("centimetres"), HasSubstr("squares of the board")));
            }
        }
    }
    Rig far;
    far.translation = {-4500, 10, 3};
    EXPECT_THAT(refused(opencv_text(far)), HasSubstr("?unit=mm (4500 mm)"));
    expect_rig(write("stereo.yml", opencv_text(far)) + "?unit=mm", far);
    for (const char* key : {"unit", "units", "length_unit"}) {
        expect_rig(write("stereo.yml", std::string(key) + ": m\n" + opencv_text(Rig(), 1000)), Rig());
    }
    // The side of a square in a unit that T has, too, although 21.6 squares of 25 mm may be taken for millimetres.
    for (const char* side : {"1", "0.025"}) {
        const std::string squares = "square_size: " + std::string(side) + "\n" + opencv_text(rigs()[2], 25);
        EXPECT_THAT(refused(squares, rigs()[2]),
                    AllOf(HasSubstr("square_size is " + std::string(side) + " there"), HasSubstr("?unit=25mm (537.4")));
        expect_rig(write("stereo.yml", squares) + "?unit=25mm", rigs()[2]);
    }
    EXPECT_THAT(refused("unit: parsec\n" + opencv_text(Rig())), HasSubstr("unit: found 'parsec'"));
    const std::string path = write("stereo.yml", opencv_text(Rig()));
    for (const auto& [settings, said] : {std::pair("unit=inch", "'unit=inch'"),
                                         {"unit=m&unit=cm", "'unit' twice"},
                                         {"pair=grey", "is an OpenCV file, for which pair says nothing"}}) {
        const std::string name = path + "?" + settings;
        EXPECT_THAT(refusal([&] { read_calibration(name, 640, 480); }), HasSubstr(said));
    }
    const std::string chain = write("camchain.yaml", camchain(Rig())) + "?model=brown";
    EXPECT_THAT(refusal([&] { read_calibration(chain, 640, 480); }), HasSubstr("model says nothing"));
    // A pair of ROS is in metres; one calibrated with a board in mm is not.
    const double baseline = Rectified(Rig()).baseline();
    const std::string pair =
        write("left.yaml", ros_text(Rig(), 0, 0)) + "," + write("right.yaml", ros_text(Rig(), 1, -1000 * baseline));
    EXPECT_THAT(refusal([&] { read_calibration(pair, 640, 480); }), HasSubstr("if its unit is m;"));
    expect_rig(pair + "?unit=mm", Rig());
}

// What the second file says counts, too, whatever the order and whatever stands in which of the two.
TEST_F(Formats, TwoFilesAreOneCalibration) {
    for (const Rig& rig : rigs()) {
        const std::string pose =
            matrix_text("R", cv::Mat(rig.rotation())) + matrix_text("T", cv::Mat(rig.translation * (1 / 1000.0)));
        const std::string whole = opencv_text(rig, 1000);
        const std::string cameras = with_other(whole, pose, "");
        const auto both = [&](const std::string& first, const std::string& second) {
            return write("a.yml", first) + "," + write("b.yml", second);
        };
        const auto said = [&](const std::string& first, const std::string& second) {
            const std::string name = both(first, second);
            return refusal([&] { read_calibration(name, rig.width, rig.height); });
        };
        expect_rig(both(cameras, "unit: m\n" + pose), rig);
        expect_rig(both("unit: m\n" + cameras, pose), rig);
        expect_rig(both(pose + "unit: m\n", cameras), rig);
        expect_rig(both("unit: m\ndate: a\n" + cameras, "date: b\n" + whole), rig);
        EXPECT_THAT(said("unit: m\n" + cameras, "unit: mm\n" + pose),
                    HasSubstr("unit: found 'm' and 'mm' that differ"));
        Rig other = rig;
        other.left[0] += 0.5;
        EXPECT_THAT(said(cameras, "unit: m\n" + opencv_text(other, 1000)),
                    AllOf(HasSubstr("a.yml"), HasSubstr("b.yml: M1: found a matrix and a matrix that differ")));
        EXPECT_THAT(said(cameras, "unit: m\nimage_width: 9\n" + pose), HasSubstr("image_width: found '"));
        EXPECT_THAT(said("square_size: 1\n" + cameras, pose), HasSubstr("square_size is 1 there"));
        EXPECT_THAT(said(cameras, pose + matrix_text("map11", cv::Mat(rig.translation))), HasSubstr("map11"));
    }
}

TEST_F(Formats, SingleCamerasExchangedOnesAndInversePosesAreTold) {
    const Rig rig;
    const double baseline = Rectified(rig).baseline();
    const std::string left = write("left.yaml", ros_text(rig, 0, 0));
    const std::string right = write("right.yaml", ros_text(rig, 1, -baseline));
    const auto said = [&](const std::string& name) { return refusal([&] { read_calibration(name, 640, 480); }); };
    EXPECT_THAT(said(right + "," + left), AllOf(HasSubstr("exchange the two files"), HasSubstr(left + "," + right)));
    EXPECT_THAT(said(left + "," + left), HasSubstr("two single cameras"));
    write("right.yaml", ros_text(rig, 1, 0));
    EXPECT_THAT(said(left + "," + right), HasSubstr("two single cameras"));

    const std::string single = size_lines(rig) + matrix_text("camera_matrix", cv::Mat(rig.left_matrix())) +
                               matrix_text("distortion_coefficients", row(rig.left_distortion));
    const std::string one = write("a.yml", single);
    EXPECT_THAT(said(one + "," + write("b.yml", "%YAML:1.0\n" + single)), HasSubstr("two single cameras"));
    EXPECT_THAT(said(one), HasSubstr("of one camera"));
    EXPECT_THAT(said(write("cam.yaml", camchain(rig).substr(0, camchain(rig).find("cam1:")))),
                HasSubstr("of one camera"));

    Rig inverse;
    inverse.turn = -rig.turn;
    inverse.translation = -(rig.rotation().t() * rig.translation);
    EXPECT_THAT(refused(opencv_text(inverse)), AllOf(HasSubstr("exchange"), HasSubstr("inverse")));
    EXPECT_THAT(refused(camchain(inverse)), HasSubstr("inverse"));
    EXPECT_THAT(refused(orbslam_3(inverse)), HasSubstr("inverse"));
}

TEST_F(Formats, FilesOfAnotherKindAreToldAsSuch) {
    const std::string ini = "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\ncamera matrix\n531 0 322\n";
    EXPECT_THAT(refused(ini), HasSubstr("ost.txt), which is not read: give its YAML"));
    EXPECT_THAT(refused(std::string("\x93NUMPY\1\0v\0", 10)), HasSubstr("bytes that are no text"));
    // Results of a rectification alone, which are not KITTI's projections.
    const Rectified results{Rig()};
    EXPECT_THAT(refused(matrix_text("P1", results.projection[0]) + matrix_text("P2", results.projection[1])),
                HasSubstr("has no matrix M1"));
}

TEST_F(Formats, NumbersOfNoCameraAreRefused) {
    Rig rig;
    const auto rectified = [](const std::string& path, const Rig& of) {
        make_rectification(read_calibration(path, of.width, of.height), of.width, of.height, {});
    };
    for (const double p1 : {5.0, -4.0, 2.5}) {
        rig.left_distortion[2] = p1;
        const std::string path = write("stereo.yml", opencv_text(rig));
        EXPECT_THAT(refusal([&] { rectified(path, rig); }), HasSubstr("cannot be rectified")) << p1;
    }
    rig = Rig();
    for (const double z : {120.0, 63.0, -90.0}) {
        rig.translation[2] = z;
        EXPECT_THAT(refused(opencv_text(rig)), HasSubstr("side by side")) << z;
    }
}

}  // namespace
}  // namespace disparityd::calibration
