// SPDX-License-Identifier: Apache-2.0
//
// Calibrations in YAML, JSON and XML: OpenCV's files and the vendor's, ROS camera_info, settings of ORB-SLAM, Kalibr's
// camchain and imu.yaml. For images so small that maps are made of what is accepted.
#include "base/text_file.h"
#include "calibration/formats/baseline_unit.h"
#include "calibration/formats/calibration_format.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/calibration_name.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/rectify.h"

using namespace disparityd;

namespace {

constexpr const char* rectified_cameras =
    "disparityd-calibration 1\nsize = 64 48\nrectified = 1\nleft = 60 60 32 24\nleft_distortion = 0 0 0 0 0\n"
    "right = 60 60 32 24\nright_distortion = 0 0 0 0 0\nrotation = 1 0 0 0 1 0 0 0 1\ntranslation = -100 0 0\n";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string path = "input";
    const calibration::CalibrationText file{path,
                                            std::string(base::without_byte_order_mark(fuzz::text_of(data, size)))};
    const auto read = [&](auto reader) {
        fuzz::accepted("calibration " + path, [&] {
            const calibration::StereoCalibration calibration = reader();
            calibration::check_plausible(calibration, path);
            fuzz::expect_same_after_text(calibration);
            fuzz::rectify(calibration, path);
        });
    };
    constexpr int width = 64, height = 48;
    const auto settled = [&](const calibration::FileCalibration& found) {
        return calibration::settle_unit(found, std::nullopt, path);
    };
    read([&] {
        return settled(
            calibration::read_opencv_calibration(file, file, width, height, calibration::LensModel::pinhole));
    });
    read([&] { return settled(calibration::read_ros_calibration(file, file, width, height, std::nullopt)); });
    read([&] { return settled(calibration::read_orbslam_settings(file, width, height)); });
    read([&] { return settled(calibration::read_euroc_sensors(file, file, width, height)); });
    read([&] { return settled(calibration::read_kalibr_camchain(file, width, height)); });
    read([&] {
        calibration::FileCalibration cameras;
        cameras.calibration = calibration::calibration_from_text(rectified_cameras, path);
        cameras.left_to_body = calibration::Pose();
        calibration::join_inertial_file(cameras, file);
        return cameras.calibration;
    });
    fuzz::accepted("calibration " + path, [&] { calibration::calibration_format(path, file.text); });
    // Any text may be the name of a calibration, too; no such file is there.
    fuzz::accepted("calibration ", [&] {
        const auto name = calibration::parse_calibration_name("/nowhere/" + file.text);
        fuzz::expect(!name.files.front().empty(), "a name was lost");
    });
    return 0;
}
