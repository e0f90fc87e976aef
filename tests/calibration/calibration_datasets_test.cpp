// SPDX-License-Identifier: Apache-2.0
//
// Factory files and the calibrations of data sets: what is read, and what contradicts itself.
#include "calibration/calibration.h"
#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using test::with_other;
using testing::AllOf;
using testing::HasSubstr;

class PlainFiles : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        write_file(folder_.file(name), text);
        return folder_.file(name);
    }
    std::string refused(const std::string& name, const std::string& text, int width, int height) const {
        const std::string path = write(name, text);
        return refusal([&] { read_calibration(path, width, height); });
    }
    TemporaryFolder folder_;
};

std::string conf(const std::string& mode, const std::string& eye, const std::string& disto,
                 const std::string& more = "") {
    const std::string camera = "fx=" + std::string(mode == "SVGA" ? "370" : "740") +
                               "\nfy=" + (mode == "SVGA" ? "370\ncx=482\ncy=301\n" : "740\ncx=963\ncy=597\n") + eye;
    std::string text = "[LEFT_CAM_" + mode + "]\n" + camera + "[RIGHT_CAM_" + mode + "]\n" + camera;
    if (!disto.empty()) {
        text += "[LEFT_DISTO]\n" + disto + "[RIGHT_DISTO]\n" + disto;
    }
    return text + "[STEREO]\nBaseline=119.9\nTY=0.03\nTZ=0.02\nCV_" + mode + "=0.006\nRX_" + mode + "=-0.001\nRZ_" +
           mode + "=0.001\nCV_VGA=1\n" + more + "[MISC]\nSensor_ID=1\n";
}

TEST_F(PlainFiles, FactoryCoefficientsOfAllModesInASectionOfTheirOwn) {
    const std::string five = "k1=-0.012\nk2=-0.031\np1=0.0002\np2=-0.0001\nk3=0.008\n";
    for (const auto& [mode, width, height] :
         {std::tuple("FHD1200", 1920, 1200), {"FHD", 1920, 1080}, {"SVGA", 960, 600}}) {
        for (const std::string& disto : {five, five + "k4=0\nk5=0\nk6=0\n"}) {
            const StereoCalibration read = read_calibration(write("SN1.conf", conf(mode, "", disto)), width, height);
            EXPECT_EQ(read.left.distortion, (std::array<double, 14>{-0.012, -0.031, 0.0002, -0.0001, 0.008})) << mode;
        }
        const std::string plain = conf(mode, five, ""), rational = with_other(plain, "k3=0.008", "k3=0.008\nK4=0.1");
        EXPECT_EQ(read_calibration(write("SN1.conf", rational), width, height).left.distortion[5], 0.1) << mode;
        const std::string own = conf(mode, "", five + "k4=0.55\nk5=0.04\nk6=0.002\n");
        EXPECT_EQ(read_calibration(write("SN1.conf", own), width, height).right.distortion,
                  (std::array<double, 14>{-0.012, -0.031, 0.0002, -0.0001, 0.008, 0.55, 0.04, 0.002}));
    }
}

TEST_F(PlainFiles, FactoryCoefficientsOfAFisheyeAreToldByTheirNames) {
    for (const char* k4 : {"k4=0.0168\n", "k4=-0.2\n", "k4=0\n"}) {
        for (const char* mode : {"FHD", "FHD1200"}) {
            const std::string eye = std::string("k1=-0.0387\nk2=0.0305\nk3=-0.0238\n") + k4;
            EXPECT_THAT(refused("SN1.conf", conf(mode, eye, ""), 1920, mode == std::string("FHD") ? 1080 : 1200),
                        AllOf(HasSubstr(std::string("[LEFT_CAM_") + mode + "]"), HasSubstr("fisheye")));
            EXPECT_THAT(refused("SN1.conf", conf(mode, "", eye), 1920, mode == std::string("FHD") ? 1080 : 1200),
                        AllOf(HasSubstr("[LEFT_DISTO]"), HasSubstr("fisheye")));
        }
    }
}

TEST_F(PlainFiles, FactoryKeysAreAllUsed) {
    const std::string eye = "k1=-0.1\nk2=0.03\np1=0\np2=0\n";
    const auto said = [&](const std::string& text) { return refused("SN1.conf", text, 1920, 1080); };
    EXPECT_THAT(said(conf("FHD", eye + "skew=0.5\n", "")), AllOf(HasSubstr("SN1.conf:10"), HasSubstr("skew")));
    EXPECT_THAT(said(conf("FHD", eye, "", "Scale=2\n")), AllOf(HasSubstr("[STEREO] scale"), HasSubstr("'2'")));
    EXPECT_THAT(said(conf("FHD", eye + "k1=-0.2\n", "")), HasSubstr("twice"));
    EXPECT_THAT(said(conf("FHD", eye, "k1=-0.2\nk2=0.03\n")),
                AllOf(HasSubstr("[LEFT_DISTO]"), HasSubstr("contradict")));
    EXPECT_THAT(said(conf("FHD", eye, "") + "[LEFT_FISHEYE]\nk1=1\n"), HasSubstr("[LEFT_FISHEYE]"));
    EXPECT_THAT(said(conf("XYZ", eye, "")), AllOf(HasSubstr("1920x1080"), testing::Not(HasSubstr("none"))));
    EXPECT_EQ(read_calibration(write("SN1.conf", conf("FHD", eye, "")), 1920, 1080).left.distortion[1], 0.03);
}

std::string middlebury(const std::string& cam0, const std::string& cam1, const std::string& doffs) {
    return "cam0=[" + cam0 + "]\ncam1=[" + cam1 + "]\n" + doffs +
           "baseline=193.001\nwidth=741\nheight=497\nndisp=70\nisint=0\nvmin=7\nvmax=65\ndyavg=0.2\ndymax=0.4\n";
}

TEST_F(PlainFiles, MiddleburyThatContradictsItself) {
    const std::string left = "999.421 0 294.182; 0 999.421 252.932; 0 0 1";
    const std::string right = "999.421 0 326.96; 0 999.421 252.932; 0 0 1";
    const auto said = [&](const std::string& text) { return refused("calib.txt", text, 741, 497); };
    for (const char* doffs : {"doffs=32.778\n", "doffs=32.78\n", ""}) {
        const auto read = read_calibration(write("calib.txt", middlebury(left, right, doffs)), 741, 497);
        EXPECT_NEAR(read.right.cx - read.left.cx, 32.778, 1e-9);
    }
    for (const char* doffs : {"doffs=0\n", "doffs=-32.778\n", "doffs=131.111\n"}) {
        EXPECT_THAT(said(middlebury(left, right, doffs)), AllOf(HasSubstr("doffs"), HasSubstr("32.778")));
    }
    EXPECT_THAT(said(middlebury(left, "1010 0 326.96; 0 1010 252.932; 0 0 1", "")), HasSubstr("focal lengths"));
    EXPECT_THAT(said(middlebury(left, "999.421 0 326.96; 0 999.421 254; 0 0 1", "")), HasSubstr("cy of the two eyes"));
    EXPECT_THAT(said(middlebury("999.421 2 294.182; 0 999.421 252.932; 0 0 1", right, "")),
                HasSubstr("cam0: found a skew"));
    EXPECT_THAT(said(middlebury(left, right, "rotation=3\n")), HasSubstr("rotation=3"));
    EXPECT_THAT(said(middlebury(left, right, "baseline=3\n")), HasSubstr("twice"));
}

TEST_F(PlainFiles, KittiPairOfTheImages) {
    const std::string grey =
        "P0: 718.9 0 607.2 0 0 718.9 185.2 0 0 0 1 0\nP1: 718.9 0 607.2 -386.1 0 718.9 185.2 0 0 0 1 0\n";
    const std::string colour =
        "P2: 718.9 0 607.2 45.38 0 718.9 185.2 -0.113 0 0 1 0.0038\nP3: 718.9 0 607.2 -337.3 0 718.9 185.2 2.369 0 0 1 "
        "0.0049\n";
    const std::string tail = "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n";
    const auto baseline = [&](const std::string& name, std::optional<KittiPair> pair) {
        return -read_calibration(name, 1241, 376, pair).translation[0];
    };
    const std::string both = write("calib.txt", grey + colour + tail);
    EXPECT_NEAR(baseline(both, KittiPair::grey), 1000 * 386.1 / 718.9, 1e-6);
    EXPECT_NEAR(baseline(both, KittiPair::colour), 1000 * (45.38 + 337.3) / 718.9, 1e-6);
    EXPECT_NEAR(baseline(both + "?pair=grey", KittiPair::colour), 1000 * 386.1 / 718.9, 1e-6);
    EXPECT_THAT(refusal([&] { read_calibration(both, 1241, 376); }),
                AllOf(HasSubstr("?pair=grey"), HasSubstr("image_2")));
    EXPECT_NEAR(baseline(write("grey.txt", grey), std::nullopt), 1000 * 386.1 / 718.9, 1e-6);
    EXPECT_NEAR(baseline(write("colour.txt", colour), std::nullopt), 1000 * (45.38 + 337.3) / 718.9, 1e-6);
    EXPECT_THAT(refusal([&] { read_calibration(both, 620, 188, KittiPair::grey); }), HasSubstr("principal point"));
}

// Numbers like those of the cars of KITTI: eyes that are turned, and a small rest in P's last column.
std::string kitti_raw(const std::string& turn_3, const std::string& translation_3, const std::string& rectified_3) {
    return "S_rect_02: 1242 375\nR_02: 0.9999758 -0.005267463 -0.004552439 0.005251945 0.9999804 -0.003413835 "
           "0.004570332 0.003389843 0.9999838\nT_02: 0.05956621 0.0002900141 0.002577209\n"
           "R_rect_02: 0.9998817 0.01511453 -0.002841595 -0.01511724 0.9998853 -0.000933851 0.002827154 0.0009766976 "
           "0.9999955\nP_rect_02: 721.5377 0 609.5593 44.85728 0 721.5377 172.854 0.2163791 0 0 1 0.002745884\n"
           "S_rect_03: 1242 375\nR_03: " +
           turn_3 + "\nT_03: " + translation_3 + "\nR_rect_03: " + rectified_3 +
           "\nP_rect_03: 721.5377 0 609.5593 -339.5242 0 721.5377 172.854 2.199936 0 0 1 0.002729905\n";
}

TEST_F(PlainFiles, KittiRawCamerasMustLeadToItsProjections) {
    const std::string turn =
        "0.9995599 0.01699522 -0.02431313 -0.01704422 0.9998531 -0.001809756 0.0242788 0.002223358 0.9997028";
    const std::string translation = "-0.473105 0.00555147 -0.005250882";
    const std::string rectified =
        "0.9998321 -0.007193136 0.01685599 0.007232804 0.9999712 -0.002293585 -0.01683901 0.002415116 0.9998553";
    const std::string identity = "1 0 0 0 1 0 0 0 1";
    const auto said = [&](const std::string& text) { return refused("calib.txt", text, 1242, 375); };
    const std::string path = write("calib_cam_to_cam.txt", kitti_raw(turn, translation, rectified));
    EXPECT_NEAR(read_calibration(path, 1242, 375).translation[0], -532.73, 0.01);
    EXPECT_THAT(said(kitti_raw(turn, "-0.373105 0.00555147 -0.005250882", rectified)),
                AllOf(HasSubstr("T_03"), HasSubstr("found a baseline of 432.7"), HasSubstr("expected 532.7"),
                      HasSubstr("P_rect_02 and P_rect_03")));
    EXPECT_THAT(said(kitti_raw(turn, "-473.105 5.55147 -5.250882", rectified)), HasSubstr("expected 532.7"));
    EXPECT_THAT(said(kitti_raw(identity, translation, rectified)), HasSubstr("expected at most 0.12 degrees"));
    EXPECT_THAT(said(kitti_raw(turn, translation, identity)), HasSubstr("R_rect_03: found an eye"));
}

}  // namespace
}  // namespace disparityd::calibration
