// SPDX-License-Identifier: Apache-2.0
#include "calibration/calibration.h"

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "capture/scene/scene_camera.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"
#include "tests/data_folder.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using testing::AllOf;
using testing::HasSubstr;

void expect_equal(const StereoCalibration& a, const StereoCalibration& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.rectified, b.rectified);
    EXPECT_EQ(a.rotation, b.rotation);
    EXPECT_EQ(a.translation, b.translation);
    for (const auto& [x, y] : {std::pair(&a.left, &b.left), std::pair(&a.right, &b.right)}) {
        EXPECT_EQ(x->fx, y->fx);
        EXPECT_EQ(x->fy, y->fy);
        EXPECT_EQ(x->cx, y->cx);
        EXPECT_EQ(x->cy, y->cy);
        EXPECT_EQ(x->distortion, y->distortion);
    }
}

/// A factory file for HD720 only.
std::string small_conf() {
    return "# a comment\r\n[Left_Cam_HD]\r\nFX=700\r\nfy=701\r\ncx = 640.5\r\ncy=360\r\nk1=-0.17\r\nk2=0.027\r\n"
           "p1=1e-4\r\np2=-2E-4\r\n\r\n[RIGHT_CAM_HD]\nfx=702\nfy=703\ncx=641\ncy=350\nk1=-0.16\nk2=0.026\nk3=0.001\n"
           "p1=0\np2=0\n[STEREO]\nBaseline=120\nTY=0.5\nty_hd=0.25\nTZ=-0.125\nCV_HD=0.01\nRX_HD=0\nRZ_HD=0\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

class CalibrationFiles : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        write_file(folder_.file(name), text);
        return folder_.file(name);
    }
    /// What reading such a file for HD720 says.
    std::string refused(const std::string& text, const std::string& name = "SN1.conf") const {
        const std::string path = write(name, text);
        return refusal([&] { read_calibration(path, 1280, 720); });
    }
    TemporaryFolder folder_;
};

TEST_F(CalibrationFiles, FactoryFileOfTheSceneReadsBackInEveryMode) {
    const std::string path = write("SN1.conf", capture::scene_calibration_conf());
    for (const auto& [width, height] : {std::pair(2208, 1242), {1920, 1080}, {1280, 720}, {672, 376}}) {
        expect_equal(read_calibration(path, width, height), capture::scene_calibration(width, height));
    }
}

TEST_F(CalibrationFiles, FactoryRules) {
    const StereoCalibration read = read_calibration(write("SN1.conf", small_conf()), 1280, 720);
    EXPECT_EQ(read.left.fx, 700);
    EXPECT_EQ(read.left.cx, 640.5);
    EXPECT_EQ(read.left.distortion, (std::array<double, 14>{-0.17, 0.027, 1e-4, -2e-4, 0}));
    EXPECT_EQ(read.right.distortion[4], 0.001);
    EXPECT_EQ(read.translation, (std::array<double, 3>{-120, 0.25, -0.125}));
    // A turn about y by CV.
    EXPECT_NEAR(read.rotation[0], std::cos(0.01), 1e-12);
    EXPECT_NEAR(read.rotation[2], std::sin(0.01), 1e-12);
    EXPECT_NEAR(read.rotation[6], -std::sin(0.01), 1e-12);
    EXPECT_EQ(read.rotation[4], 1);
    EXPECT_FALSE(read.rectified);
}

TEST_F(CalibrationFiles, FactoryFileThatCannotBeMeant) {
    const std::string conf = small_conf();
    EXPECT_THAT(refused("<!DOCTYPE html>\n<html><body>404</body></html>"),
                AllOf(HasSubstr("SN1.conf"), HasSubstr("web page")));
    EXPECT_THAT(refused(replaced(conf, "fy=701", "fy=701,25")),
                AllOf(HasSubstr("SN1.conf:4"), HasSubstr("fy"), HasSubstr("701,25"), HasSubstr("decimal comma")));
    EXPECT_THAT(refused(replaced(conf, "fy=701\r\n", "")), AllOf(HasSubstr("[LEFT_CAM_HD]"), HasSubstr("fy")));
    EXPECT_THAT(refused(replaced(conf, "CV_HD=0.01\n", "")), AllOf(HasSubstr("[STEREO]"), HasSubstr("cv_hd")));
    EXPECT_THAT(refused(replaced(conf, "Baseline=120\n", "")), AllOf(HasSubstr("[STEREO]"), HasSubstr("baseline")));
    for (const char* value : {"nan", "inf", "1e999", "", "0x10", "12 13"}) {
        EXPECT_THAT(refused(replaced(conf, "fy=701", std::string("fy=") + value)), HasSubstr("fy")) << value;
    }
    for (const char* value : {"0", "-120", "1e9"}) {
        EXPECT_THAT(refused(replaced(conf, "Baseline=120", std::string("Baseline=") + value)), HasSubstr("SN1.conf"))
            << value;
    }
    EXPECT_THAT(refused(replaced(conf, "FX=700", "FX=-700")), HasSubstr("left fx"));
    EXPECT_THAT(refused(replaced(conf, "cx = 640.5", "cx = 64050")), HasSubstr("left cx"));
    EXPECT_THAT(refused(replaced(conf, "k1=-0.17", "k1=-1700")), HasSubstr("left distortion"));
    EXPECT_THAT(refused(""), HasSubstr("SN1.conf"));
    EXPECT_THAT(refused("[LEFT_CAM_HD\nfx=1\n"), HasSubstr("SN1.conf:1"));
    EXPECT_THAT(refused("whatever", "notes.txt"), HasSubstr("no known format"));
}

TEST_F(CalibrationFiles, FactoryFileForAnotherMode) {
    const std::string path = write("SN1.conf", small_conf());
    EXPECT_THAT(refusal([&] { read_calibration(path, 672, 376); }),
                AllOf(HasSubstr("1280x720"), HasSubstr("672x376"), HasSubstr("SN1.conf")));
    EXPECT_THAT(refusal([&] { read_calibration(path, 640, 360); }), HasSubstr("640x360"));
    EXPECT_THAT(refusal([&] { read_calibration(folder_.file("absent.conf"), 1280, 720); }), HasSubstr("no such file"));
}

std::string matrix(const std::string& name, int rows, int columns, const std::string& numbers) {
    return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(columns) +
           "\n   dt: d\n   data: [ " + numbers + " ]\n";
}

std::string intrinsics() {
    return matrix("M1", 3, 3, "534.5, 0., 335.75, 0., 535., 240.5, 0., 0., 1.") +
           matrix("D1", 1, 5, "-0.29, 0.1, 0.001, -0.002, 0.03") +
           matrix("cameraMatrix2", 3, 3, "536., 0., 334., 0., 537., 241., 0., 0., 1.") +
           matrix("D2", 1, 4, "-0.28, 0.11, 0., 0.");
}

std::string extrinsics() {
    return matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.") + matrix("T", 3, 1, "-60.5, 0.25, 0.125");
}

TEST_F(CalibrationFiles, OpenCvInOneFileAndInTwo) {
    const std::string head = "%YAML:1.0\n---\n";
    const std::string one =
        write("stereo.yml", head + "image_width: 640\nimage_height: 480\n" + intrinsics() + extrinsics());
    const std::string inner = write("intrinsics.yml", head + intrinsics());
    const std::string outer = write("extrinsics.yml", head + extrinsics());
    const StereoCalibration read = read_calibration(one, 640, 480);
    expect_equal(read, read_calibration(inner + "," + outer, 640, 480));
    EXPECT_EQ(read.left.fx, 534.5);
    EXPECT_EQ(read.left.cy, 240.5);
    EXPECT_EQ(read.left.distortion, (std::array<double, 14>{-0.29, 0.1, 0.001, -0.002, 0.03}));
    EXPECT_EQ(read.right.fy, 537);
    EXPECT_EQ(read.right.distortion, (std::array<double, 14>{-0.28, 0.11, 0, 0, 0}));
    EXPECT_EQ(read.translation, (std::array<double, 3>{-60.5, 0.25, 0.125}));
    EXPECT_THAT(refusal([&] { read_calibration(one, 1280, 720); }), AllOf(HasSubstr("640x480"), HasSubstr("1280x720")));
    EXPECT_THAT(refusal([&] { read_calibration(inner, 640, 480); }), HasSubstr("has no matrix R"));
}

std::string xml_matrix(const std::string& name, int rows, int columns, const std::string& numbers) {
    return "<" + name + " type_id=\"opencv-matrix\">\n  <rows>" + std::to_string(rows) + "</rows>\n  <cols>" +
           std::to_string(columns) + "</cols>\n  <dt>d</dt>\n  <data>\n    " + numbers + "</data></" + name + ">\n";
}

TEST_F(CalibrationFiles, OpenCvInXml) {
    const std::string text =
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- <M1> of a comment -->\n"
        "<image_width>640</image_width>\n<image_height>480</image_height>\n" +
        xml_matrix("M1", 3, 3, "534.5 0. 335.75\n 0. 535. 240.5 0. 0. 1.") +
        xml_matrix("D1", 1, 5, "-0.29 0.1 0.001 -0.002 0.03") +
        xml_matrix("M2", 3, 3, "536. 0. 334. 0. 537. 241. 0. 0. 1.") + xml_matrix("D2", 1, 4, "-2.8e-01 0.11 0. 0.") +
        xml_matrix("R", 3, 3, "1. 0. 0. 0. 1. 0. 0. 0. 1.") + xml_matrix("T", 3, 1, "-60.5 0.25 0.125") +
        "</opencv_storage>\n";
    const StereoCalibration read = read_calibration(write("stereo.xml", text), 640, 480);
    expect_equal(
        read, read_calibration(
                  write("stereo.yml", "%YAML:1.0\n---\n" + replaced(intrinsics(), "-0.28", "-2.8e-01") + extrinsics()),
                  640, 480));
    const auto said = [&](const std::string& damaged) {
        const std::string path = write("damaged.xml", damaged);
        return refusal([&] { read_calibration(path, 640, 480); });
    };
    EXPECT_THAT(said(text.substr(0, text.size() - 20)), HasSubstr("no whole <opencv_storage>"));
    EXPECT_THAT(said(replaced(text, "</D1>", "")), HasSubstr("not closed"));
    EXPECT_THAT(said(replaced(text, "<rows>1</rows>", "<rows>1000000</rows>")), HasSubstr("D1 is no matrix"));
    EXPECT_THAT(said(replaced(text, "0.03", "o.o3")), HasSubstr("'o.o3'"));
}

TEST_F(CalibrationFiles, OpenCvThatCannotBeMeant) {
    const std::string head = "%YAML:1.0\n---\n";
    const auto said = [&](const std::string& text) {
        const std::string path = write("stereo.yml", head + text);
        return refusal([&] { read_calibration(path, 640, 480); });
    };
    EXPECT_THAT(said(replaced(intrinsics(), "-0.28, 0.11, 0., 0.", ".Nan, 0.11, 0., 0.") + extrinsics()),
                HasSubstr("D2"));
    EXPECT_THAT(said(intrinsics() + replaced(extrinsics(), "-60.5", "60.5")), HasSubstr("exchange"));
    for (const char* numbers : {"0., 0., 0., 0., 0., 0., 0., 0., 0.", "1., 0., 0., 0., 1., 0., 0., 0., -1.",
                                "1., 0., 0., 0., 1.1, 0., 0., 0., 1.", "1., 0.1, 0., 0., 1., 0., 0., 0., 1."}) {
        EXPECT_THAT(said(intrinsics() + matrix("R", 3, 3, numbers) + matrix("T", 3, 1, "-60.5, 0.25, 0.125")),
                    HasSubstr("is no rotation"))
            << numbers;
    }
    EXPECT_THAT(said(intrinsics() + matrix("R", 3, 3, "0., 0., 1., 0., 1., 0., -1., 0., 0.") +
                     matrix("T", 3, 1, "-60.5, 0.25, 0.125")),
                HasSubstr("directions of the two cameras: found 90, allowed is 0 to 45"));
    EXPECT_THAT(said(intrinsics() + "R: hello\nT: 3\n"), HasSubstr("R"));
    EXPECT_THAT(said(matrix("M1", 1, 2, "1., 2.") + matrix("D1", 1, 1, "0.") + matrix("M2", 1, 2, "1., 2.") +
                     matrix("D2", 1, 1, "0.") + extrinsics()),
                HasSubstr("expected 3x3"));
    EXPECT_THAT(said(replaced(intrinsics(), "cols: 4\n   dt: d\n   data: [ -0.28, 0.11, 0., 0. ]",
                              "cols: 6\n   dt: d\n   data: [ 0., 0., 0., 0., 0., 0.3 ]") +
                     extrinsics()),
                HasSubstr("found 6 distortion coefficients"));
    EXPECT_THAT(said("M1: [ 1, 2\n"), HasSubstr("stereo.yml"));
}

std::string camera_info(const std::string& distortion, const std::string& turn, const std::string& shift) {
    return "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n"
           "  rows: 1\n  cols: 5\n  data: [" +
           distortion + "]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [" + turn +
           "]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  data: [480, 0, 322, " + shift +
           ", 0, 480, 238, 0, 0, 0, 1, 0]\n";
}

TEST_F(CalibrationFiles, RosPairGivesRotationAndTranslation) {
    // The left eye is turned by 3-4-5 about y (sine 0.6), the right one not: R = R2^T R1, T = R2^T (Tx / f, 0, 0).
    const std::string turn = "0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8";
    const std::string none = "1, 0, 0, 0, 1, 0, 0, 0, 1";
    const std::string left = write("left.yaml", camera_info("-0.1, 0.02, 0, 0, 0", turn, "0"));
    const std::string right = write("right.yaml", camera_info("-0.2, 0.03, 0, 0, 0", none, "-57.6"));
    const StereoCalibration read = read_calibration(left + "," + right, 640, 480);
    EXPECT_EQ(read.rotation, (std::array<double, 9>{0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8}));
    EXPECT_NEAR(read.translation[0], -120, 1e-12);
    EXPECT_EQ(read.left.distortion[0], -0.1);
    EXPECT_EQ(read.right.distortion[1], 0.03);
    EXPECT_EQ(read.left.fy, 501);
    EXPECT_THAT(refusal([&] { read_calibration(left, 640, 480); }), HasSubstr("left.yaml,right.yaml"));
    EXPECT_THAT(refusal([&] { read_calibration(left + "," + right, 672, 376); }),
                AllOf(HasSubstr("640x480"), HasSubstr("672x376")));
    write("right.yaml", camera_info("-0.2, 0,03, 0, x, 0", none, "-57.6"));
    EXPECT_THAT(refusal([&] { read_calibration(left + "," + right, 640, 480); }), HasSubstr("right.yaml"));
    write("right.yaml", camera_info("0, 0, 0, 0, 0", none, "57.6"));
    EXPECT_THAT(refusal([&] { read_calibration(left + "," + right, 640, 480); }), HasSubstr("exchange"));
    write("right.yaml", "camera_matrix: [\n");
    EXPECT_THAT(refusal([&] { read_calibration(left + "," + right, 640, 480); }), HasSubstr("right.yaml"));
}

TEST_F(CalibrationFiles, WhatIsDeepIsRefusedAsADamagedFile) {
    // Each level costs the parser some stack: yaml-cpp ends at 500 of them.
    for (const std::string level : {"[", "{a: ", "- ", "? ", ": "}) {
        std::string deep = "camera_matrix: " + std::string(level == "[" || level[0] == '{' ? "" : "\n  ");
        for (int i = 0; i < 100'000; ++i) {
            deep += level;
        }
        const std::string left = write("deep.yaml", deep + "\n");
        const std::string opencv = write("deep.yml", "%YAML:1.0\n" + deep + "\n");
        EXPECT_THAT(refusal([&] { read_calibration(left + "," + left, 640, 480); }), HasSubstr("deep.yaml: line "))
            << level;
        EXPECT_THAT(refusal([&] { read_calibration(opencv, 640, 480); }), HasSubstr("deep.yml: line ")) << level;
    }
    std::string tags;
    for (int i = 0; i < 100'000; ++i) {
        tags += "<M1>";
    }
    const std::string xml =
        write("deep.xml", "<?xml version=\"1.0\"?>\n<opencv_storage>" + tags + "</opencv_storage>\n");
    EXPECT_THAT(refusal([&] { read_calibration(xml, 640, 480); }), HasSubstr("deep.xml: is a damaged"));
}

TEST(CalibrationText, ComesBackToTheBit) {
    StereoCalibration calibration = capture::test::make_calibration(1280, 720);
    expect_equal(calibration_from_text(to_text(calibration), "recording"), calibration);
    EXPECT_EQ(calibration_from_text(to_text(calibration), "recording").origin, "recording");
    StereoCalibration rectified;
    rectified.width = 7;
    rectified.height = 5;
    rectified.rectified = true;
    expect_equal(calibration_from_text(to_text(rectified), "recording"), rectified);
}

TEST(CalibrationText, DamageIsRefused) {
    const std::string text = to_text(capture::test::make_calibration(1280, 720));
    const auto said = [](const std::string& damaged) {
        return refusal([&] { calibration_from_text(damaged, "my.mkv"); });
    };
    EXPECT_THAT(said(""), HasSubstr("my.mkv"));
    EXPECT_THAT(said("disparityd-calibration 2\n"), HasSubstr("my.mkv"));
    EXPECT_THAT(said(replaced(text, "size = 1280", "size = 0")), HasSubstr("width"));
    EXPECT_THAT(said(replaced(text, "size = 1280", "size = nan")), HasSubstr("size"));
    for (const char* key : {"left =", "right_distortion =", "rotation =", "translation =", "rectified ="}) {
        EXPECT_THAT(said(replaced(text, key, "other =")), HasSubstr("my.mkv")) << key;
    }
    EXPECT_NE(said(text.substr(0, text.size() / 2)), "");
}

/// Puts the process under a locale with a decimal comma for as long as it lives.
class CommaLocale {
public:
    CommaLocale() {
        for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8", "pt_BR.UTF-8"}) {
            if (std::setlocale(LC_ALL, name) != nullptr && std::localeconv()->decimal_point[0] == ',') {
                found_ = true;
                return;
            }
        }
        std::setlocale(LC_ALL, "C");
    }
    ~CommaLocale() { std::setlocale(LC_ALL, "C"); }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;
    bool found() const { return found_; }

private:
    bool found_ = false;
};

TEST_F(CalibrationFiles, AByteOrderMarkOfAnEditorIsPassedOver) {
    const std::string mark = "\xef\xbb\xbf";
    expect_equal(read_calibration(write("SN2.conf", mark + small_conf()), 1280, 720),
                 read_calibration(write("SN1.conf", small_conf()), 1280, 720));
    const std::string opencv = "%YAML:1.0\n---\n" + intrinsics() + extrinsics();
    expect_equal(read_calibration(write("marked.yml", mark + opencv), 640, 480),
                 read_calibration(write("stereo.yml", opencv), 640, 480));
}

TEST_F(CalibrationFiles, TheProcessLocaleChangesNothing) {
    const CommaLocale locale;
    if (!locale.found()) {
        GTEST_SKIP() << "no locale with a decimal comma is installed, such as de_DE.UTF-8";
    }
    expect_equal(read_calibration(write("SN1.conf", capture::scene_calibration_conf()), 672, 376),
                 capture::scene_calibration(672, 376));
    const StereoCalibration calibration = capture::scene_calibration(672, 376);
    expect_equal(calibration_from_text(to_text(calibration), "recording"), calibration);
    const std::string opencv = write("stereo.yml", "%YAML:1.0\n---\n" + intrinsics() + extrinsics());
    EXPECT_EQ(read_calibration(opencv, 640, 480).left.fx, 534.5);
}

TEST(RealCalibration, FactoryFilesOfTwoCameras) {
    const std::filesystem::path zed = disparityd::test::data_folder() / "zed";
    if (!std::filesystem::is_directory(zed)) {
        GTEST_SKIP() << "no evaluation data at DISPARITYD_DATA or ../shared/data";
    }
    const std::string complete = (zed / "SN5867575.conf").string();
    for (const auto& [width, height] : {std::pair(2208, 1242), {1920, 1080}, {1280, 720}, {672, 376}}) {
        const StereoCalibration read = read_calibration(complete, width, height);
        EXPECT_NEAR(-read.translation[0], 120, 1);
        EXPECT_NEAR(read.left.cx, width / 2.0, 0.05 * width);
    }
    const std::string part = (zed / "SN21531_derived.conf").string();
    EXPECT_EQ(read_calibration(part, 1280, 720).left.fx, 699.34);
    EXPECT_THAT(refusal([&] { read_calibration(part, 672, 376); }), HasSubstr("1280x720"));
}

}  // namespace
}  // namespace disparityd::calibration
