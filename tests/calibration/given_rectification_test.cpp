// SPDX-License-Identifier: Apache-2.0
//
// What a file says about rectification beside cameras and pose: it must agree with them.
#include "calibration/calibration.h"
#include "calibration/rectification.h"
#include "tests/calibration/calibration_texts.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/recording/record_fixture.h"

namespace disparityd::calibration {
namespace {

using capture::test::refusal;
using capture::test::TemporaryFolder;
using capture::test::write_file;
using test::camchain;
using test::matrix_text;
using test::opencv_text;
using test::orbslam_2;
using test::orbslam_3;
using test::Rig;
using test::rigs;
using test::row;
using test::size_lines;
using test::with_other;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

/// What stereoRectify makes of a rig, with any alpha and size, and what stereoCalibrate writes beside R and T.
struct Results {
    cv::Mat turn[2], projection[2], to_depth, essential, fundamental;

    explicit Results(const Rig& rig, double alpha = 0, cv::Size size = {}, int flags = cv::CALIB_ZERO_DISPARITY) {
        cv::stereoRectify(rig.left_matrix(), rig.left_distortion, rig.right_matrix(), rig.right_distortion,
                          {rig.width, rig.height}, rig.rotation(), rig.translation, turn[0], turn[1], projection[0],
                          projection[1], to_depth, flags, alpha, size);
        const cv::Vec3d& t = rig.translation;
        const cv::Matx33d cross(0, -t[2], t[1], t[2], 0, -t[0], -t[1], t[0], 0);
        essential = cv::Mat(cross * rig.rotation());
        fundamental =
            cv::Mat(rig.right_matrix().inv().t() * cv::Matx33d(essential.ptr<double>()) * rig.left_matrix().inv());
    }
    std::string text() const {
        return matrix_text("R1", turn[0]) + matrix_text("R2", turn[1]) + matrix_text("P1", projection[0]) +
               matrix_text("P2", projection[1]) + matrix_text("Q", to_depth) + matrix_text("E", essential) +
               matrix_text("F", fundamental);
    }
    void write(cv::FileStorage& file) const {
        file << "R1" << turn[0] << "R2" << turn[1] << "P1" << projection[0] << "P2" << projection[1] << "Q" << to_depth
             << "E" << essential << "F" << fundamental;
    }
};

class GivenRectification : public testing::Test {
protected:
    std::string write(const std::string& name, const std::string& text) const {
        write_file(folder_.file(name), text);
        return folder_.file(name);
    }
    /// What reading the text as a file for images of this size says; empty when it is read.
    std::string said(const std::string& text, int width = 640, int height = 480,
                     const std::string& name = "stereo.yml") const {
        const std::string path = write(name, text);
        try {
            read_calibration(path, width, height);
        } catch (const std::invalid_argument& error) {
            EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
            return error.what();
        }
        return {};
    }
    std::string said(const std::string& text, const Rig& rig) const { return said(text, rig.width, rig.height); }
    TemporaryFolder folder_;
};

/// Made with numpy, not with OpenCV. The rotations are those of Fusiello, Trucco and Verri (y at right angles to the
/// left eye's axis), which stand 0.4 degrees about the baseline from OpenCV's; f, cx and cy are of another image size.
struct NumpyFile {
    std::string cameras =
        "image_size: [ 752, 480 ]\nunit: m\n"
        "M1:\n  rows: 3\n  cols: 3\n  dt: d\n  data: [ 461.3, 0, 370.2, 0, 460.1, 236.9, 0, 0, 1 ]\n"
        "D1:\n  rows: 1\n  cols: 5\n  dt: d\n  data: [ -0.2834, 0.0739, 0.00019, 1.76e-05, 0 ]\n"
        "M2:\n  rows: 3\n  cols: 3\n  dt: d\n  data: [ 459.8, 0, 377.5, 0, 458.9, 244.3, 0, 0, 1 ]\n"
        "D2:\n  rows: 1\n  cols: 5\n  dt: d\n  data: [ -0.2831, 0.0741, -0.000105, -3.59e-05, 0 ]\n";
    std::string pose =
        "R:\n  rows: 3\n  cols: 3\n  dt: d\n  data: [ 0.9999463364, -0.008343285398, -0.006141170153, 0.008255867628, "
        "0.9998661534, -0.01412500993, 0.006258197167, 0.01407355124, 0.999881378 ]\n"
        "T:\n  rows: 3\n  cols: 1\n  dt: d\n  data: [ -0.1101, 0.0005, -0.0013 ]\n";
    std::string r1 =
        "[ 0.9999027284, -0.01271681335, 0.005728564895, 0.01271702201, 0.9999191354, 0, -0.005728101657, "
        "7.285028587e-05, 0.9999835916 ]\n";
    std::string r2 =
        "[ 0.9999199899, -0.004540962715, 0.01180650306, 0.00437372885, 0.9998902897, 0.01415199882, -0.01186947146, "
        "-0.01409922807, 0.9998301493 ]\n";
    std::string p1 = "[ 431.9, 0, 368.25, 0, 0, 431.9, 251.75, 0, 0, 0, 1, 0 ]\n";
    std::string p2 = "[ 431.9, 0, 368.25, -47.55599496, 0, 431.9, 251.75, 0, 0, 0, 1, 0 ]\n";
    std::string q = "[ 1, 0, 0, -368.25, 0, 1, 0, -251.75, 0, 0, 0, 431.9, 0, 0, 9.08192543, 0 ]\n";
    std::string e =
        "[ 1.38617265e-05, 0.001306862775, 0.0004815781761, -0.0006109027292, 0.001560344262, 0.1100949232, "
        "-0.001408944194, -0.1100810918, 0.001558234178 ]\n";
    std::string f =
        "[ 5.989379349e-08, 5.661424293e-06, -0.0004034889498, -2.644767319e-06, 6.772781331e-06, 0.2192447098, "
        "-0.002175650224, -0.223060867, 1 ]\n";

    std::string text() const {
        const auto matrix = [](const std::string& name, int rows, int columns, const std::string& data) {
            return data.empty() ? data
                                : name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
                                      "\n  dt: d\n  data: " + data;
        };
        return cameras + pose + matrix("R1", 3, 3, r1) + matrix("R2", 3, 3, r2) + matrix("P1", 3, 4, p1) +
               matrix("P2", 3, 4, p2) + matrix("Q", 4, 4, q) + matrix("E", 3, 3, e) + matrix("F", 3, 3, f);
    }
};

TEST_F(GivenRectification, OfAnotherProgramAgrees) {
    const NumpyFile file;
    EXPECT_THAT(said(file.text(), 752, 480), IsEmpty());
    // It changes nothing: the rectified camera is ours.
    const auto rectified = [&](const std::string& text) {
        return make_rectification(read_calibration(write("stereo.yml", text), 752, 480), 752, 480, {}).calibration_id;
    };
    EXPECT_EQ(rectified(file.text()), rectified(file.cameras + file.pose));
}

TEST_F(GivenRectification, OfOpenCvAgreesWhateverItWasMadeWith) {
    for (const Rig& rig : rigs()) {
        const cv::Size half(rig.width / 2, rig.height / 2), wide(rig.width * 2, rig.height);
        for (const double alpha : {-1.0, 0.0, 0.5, 1.0}) {
            for (const cv::Size& size : {cv::Size(), half, wide}) {
                for (const int flags : {0, static_cast<int>(cv::CALIB_ZERO_DISPARITY)}) {
                    const Results results(rig, alpha, size, flags);
                    EXPECT_THAT(said(opencv_text(rig) + results.text(), rig), IsEmpty()) << alpha << ' ' << size;
                }
            }
        }
        for (const char* name : {"stereo.json", "stereo.xml", "stereo.yml"}) {
            cv::FileStorage file(folder_.file(name), cv::FileStorage::WRITE);
            test::put_by_opencv(rig, file);
            Results(rig, 1).write(file);
            file.release();
            EXPECT_NO_THROW(read_calibration(folder_.file(name), rig.width, rig.height)) << name;
        }
    }
}

TEST_F(GivenRectification, TurnsThatContradictThePose) {
    NumpyFile file;
    std::swap(file.r1, file.r2);
    EXPECT_THAT(said(file.text(), 752, 480),
                AllOf(HasSubstr("R1 and R2: found each in place of the other"), HasSubstr("exchange")));
    for (const Rig& rig : rigs()) {
        Results results(rig);
        std::swap(results.turn[0], results.turn[1]);
        EXPECT_THAT(said(opencv_text(rig) + results.text(), rig), HasSubstr("exchange the two"));
        // Of the same cameras after a knock: the right one has turned by a quarter of a degree.
        for (const cv::Vec3d& knock : {cv::Vec3d(0.0044, 0, 0), {0, 0.0044, 0}, {0, 0, 0.0044}}) {
            Rig knocked = rig;
            cv::Matx33d turn;
            cv::Rodrigues(knock, turn);
            cv::Rodrigues(turn * rig.rotation(), knocked.turn);
            const Results other(knocked);
            EXPECT_THAT(
                said(opencv_text(rig) + matrix_text("R1", other.turn[0]) + matrix_text("R2", other.turn[1]), rig),
                AllOf(HasSubstr("R1 and R2: found eyes that are turned to each other by 0.252 degrees"),
                      HasSubstr("expected at most 0.12 degrees"), HasSubstr("take R1 and R2 out")));
        }
    }
}

TEST_F(GivenRectification, OneTurnAloneStillHasToPutTheRowsAlongTheBaseline) {
    const Rig rig;
    Rig other = rig;
    other.translation = {-120, 9, 0.4};
    for (const int eye : {0, 1}) {
        const std::string name = eye == 0 ? "R1" : "R2";
        EXPECT_THAT(said(opencv_text(rig) + matrix_text(name, Results(rig).turn[eye])), IsEmpty());
        EXPECT_THAT(said(opencv_text(rig) + matrix_text(name, Results(other).turn[eye])),
                    AllOf(HasSubstr(name + ": found rows that run"), HasSubstr("beside the baseline")));
        const cv::Mat twice = 2 * Results(rig).turn[eye];
        EXPECT_THAT(said(opencv_text(rig) + matrix_text(name, twice)), HasSubstr("no rotation"));
    }
    // As a rotation vector, as R may be.
    cv::Mat vector;
    cv::Rodrigues(Results(rig).turn[0], vector);
    EXPECT_THAT(said(opencv_text(rig) + matrix_text("R1", vector)), IsEmpty());
    EXPECT_THAT(said(opencv_text(rig) + matrix_text("R1", Results(rig).projection[0])), HasSubstr("expected 3x3"));
}

TEST_F(GivenRectification, AnotherBaseline) {
    NumpyFile file;
    file.p2 = with_other(file.p2, "-47.55599496", "-25.914");  // 60 mm
    EXPECT_THAT(said(file.text(), 752, 480),
                AllOf(HasSubstr("P1 and P2: found a baseline of 0.06, expected 0.11011, the length of T"),
                      HasSubstr("take P1 and P2 out")));
    file = NumpyFile();
    file.p2 = with_other(file.p2, "-47.55599496", "-47555.99496");  // millimetres beside metres
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("found a baseline of 110.11, expected 0.11011"));
    file = NumpyFile();
    std::swap(file.p1, file.p2);
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("found a baseline of -0.11011, expected 0.11011"));
    file.p1.clear();
    file.p2 = with_other(NumpyFile().p2, "-47.55599496", "-25.914");
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("stereo.yml: P2: found a baseline of 0.06"));
    // The unit that the user names is that of all lengths.
    const Rig rig;
    const std::string squares = write("stereo.yml", opencv_text(rig, 25) + matrix_text("Q", Results(rig).to_depth));
    EXPECT_THAT(refusal([&] { read_calibration(squares + "?unit=25mm", 640, 480); }),
                HasSubstr("Q: found a baseline of 120, expected 4.8002"));
}

TEST_F(GivenRectification, ALeftProjectionWithAShift) {
    NumpyFile file;
    file.p1 = with_other(file.p1, "368.25, 0,", "368.25, 25.5,");
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("P1 and P2: found a baseline of 0.16915"));
    // Both as seen from a third camera: what they differ by is the baseline.
    file.p2 = with_other(file.p2, "-47.55599496", "-22.05599496");
    EXPECT_THAT(said(file.text(), 752, 480), IsEmpty());
    file.p2.clear();
    EXPECT_THAT(said(file.text(), 752, 480),
                AllOf(HasSubstr("P1: found a shift of 0.059041"), HasSubstr("expected 0")));
}

TEST_F(GivenRectification, ProjectionsOfNoRectifiedPair) {
    NumpyFile file;
    file.p1 = "[ 461.3, 0, 370.2, 0, 0, 460.1, 236.9, 0, 0, 0, 1, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480),
                AllOf(HasSubstr("focal lengths of the two eyes of 461.3 and 431.9"), HasSubstr("take P1 and P2 out")));
    file = NumpyFile();
    file.p2 = with_other(file.p2, "251.75", "263.75");
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("cy of the two eyes"));
}

TEST_F(GivenRectification, DepthOfAnotherRig) {
    NumpyFile file;
    file.q = "[ 1, 0, 0, -368.25, 0, 1, 0, -251.75, 0, 0, 0, 431.9, 0, 0, 15.9, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("Q: found a baseline of 0.062893, expected 0.11011"));
    file.q = "[ 1, 0, 0, -368.25, 0, 1, 0, -251.75, 0, 0, 0, 431.9, 0, 0, -9.08192543, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("Q: found a baseline of -0.11011"));
    // The same baseline, and another lens than P1 is of.
    file.q = "[ 1, 0, 0, -368.25, 0, 1, 0, -251.75, 0, 0, 0, 700.1, 0, 0, 9.08192543, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("Q: found f 700.1, expected 431.9 as P1 has it"));
    file.p1.clear();
    EXPECT_THAT(said(file.text(), 752, 480), IsEmpty());
    // All numbers of Q may have a factor in common.
    file.q = "[ 2, 0, 0, -736.5, 0, 2, 0, -503.5, 0, 0, 0, 863.8, 0, 0, 18.16385086, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), IsEmpty());
    file.q = "[ 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("Q: found"));
}

TEST_F(GivenRectification, EpipolarMatricesOfAnotherPose) {
    NumpyFile file;
    file.f = "[ 5.9e-08, -2.6e-06, -0.0021, 5.6e-06, 6.7e-06, -0.223, -0.0004, 0.2192, 1 ]\n";  // transposed
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("F: found a pose of the eyes that differs from R and T by"));
    file = NumpyFile();
    file.e = "[ 0, 0, 0, 0, 0, 0, 0, 0, 0 ]\n";
    EXPECT_THAT(said(file.text(), 752, 480), HasSubstr("E: found"));
    for (const Rig& rig : rigs()) {
        for (const cv::Vec3d& other : {cv::Vec3d(0.03, 0, 0), {0, 0.03, 0}, {0, 0, 0.03}}) {
            Rig turned = rig;
            turned.turn += other;
            EXPECT_THAT(said(opencv_text(rig) + matrix_text("E", Results(turned).essential), rig),
                        HasSubstr("expected at most 0.5 degrees"));
            EXPECT_THAT(said(opencv_text(rig) + matrix_text("F", Results(turned).fundamental), rig),
                        HasSubstr("expected at most 0.5 degrees"));
        }
        // Neither has a scale.
        EXPECT_THAT(said(opencv_text(rig) + matrix_text("E", Results(rig).essential * -2.5), rig), IsEmpty());
    }
}

TEST_F(GivenRectification, InTheFileOfThePose) {
    const Rig rig;
    Rig other = rig;
    other.translation = {-63, 0.2, 0.1};
    const std::string pose = matrix_text("R", cv::Mat(rig.rotation())) + matrix_text("T", cv::Mat(rig.translation));
    const std::string cameras = write("intrinsics.yml", with_other(opencv_text(rig), pose, ""));
    const auto read = [&](const Results& results) {
        read_calibration(cameras + "," + write("extrinsics.yml", pose + results.text()), rig.width, rig.height);
    };
    EXPECT_NO_THROW(read(Results(rig)));
    EXPECT_THAT(refusal([&] { read(Results(other)); }), AllOf(HasSubstr("extrinsics.yml: "), HasSubstr("contradict")));
}

TEST_F(GivenRectification, OrbSlamsOwnStatements) {
    const Rig rig;
    const double f = test::Rectified(rig).f();
    const auto two = [&](const std::string& line) { return said(line + orbslam_2(rig).substr(10), rig); };
    EXPECT_THAT(two("%YAML:1.0\nCamera.fx: " + std::to_string(f) + "\nCamera.k1: 0.0\n"), IsEmpty());
    EXPECT_THAT(two("%YAML:1.0\nCamera.fx: 531.2\n"), AllOf(HasSubstr("Camera.fx: found 531.2"), HasSubstr("LEFT.P")));
    EXPECT_THAT(two("%YAML:1.0\nCamera.cy: 12.5\n"), HasSubstr("Camera.cy: found 12.5"));
    EXPECT_THAT(two("%YAML:1.0\nCamera.k1: -0.28\n"), HasSubstr("Camera.k1: found -0.28, expected 0"));
    EXPECT_THAT(said(orbslam_3(rig) + "Stereo.b: 0.12\n", rig), IsEmpty());
    EXPECT_THAT(said(orbslam_3(rig) + "Stereo.b: 0.0746\n", rig), HasSubstr("Stereo.b: found 0.0746, expected 0.12"));
}

TEST_F(GivenRectification, KalibrsPosesToTheImu) {
    const Rig rig;
    const std::string left =
        "  T_cam_imu:\n  - [0, -1, 0, 0.02]\n  - [0, 0, -1, -0.01]\n  - [1, 0, 0, 0.03]\n  - [0, 0, 0, 1]\n";
    const cv::Matx44d left_pose(0, -1, 0, 0.02, 0, 0, -1, -0.01, 1, 0, 0, 0.03, 0, 0, 0, 1);
    const auto chain = [&](const cv::Vec3d& turn, const cv::Vec3d& translation) {
        cv::Matx33d r;
        cv::Rodrigues(turn, r);
        const cv::Vec3d t = translation * (1 / 1000.0);
        const cv::Matx44d right = cv::Matx44d(r(0, 0), r(0, 1), r(0, 2), t[0], r(1, 0), r(1, 1), r(1, 2), t[1], r(2, 0),
                                              r(2, 1), r(2, 2), t[2], 0, 0, 0, 1) *
                                  left_pose;
        std::ostringstream text;
        text.precision(12);
        text << "cam1:\n  T_cam_imu:\n";
        for (int i = 0; i < 4; ++i) {
            text << "  - [" << right(i, 0) << ", " << right(i, 1) << ", " << right(i, 2) << ", " << right(i, 3)
                 << "]\n";
        }
        return said(with_other(with_other(camchain(rig), "cam1:\n", text.str()), "cam0:\n", "cam0:\n" + left), rig);
    };
    EXPECT_THAT(chain(rig.turn, rig.translation), IsEmpty());
    EXPECT_THAT(chain(rig.turn + cv::Vec3d(0, 0.004, 0), rig.translation),
                HasSubstr("T_cn_cnm1: found a pose that differs"));
    EXPECT_THAT(chain(rig.turn, {-110, 0.9, -0.6}), AllOf(HasSubstr("10 mm"), HasSubstr("T_cam_imu")));
}

}  // namespace
}  // namespace disparityd::calibration
