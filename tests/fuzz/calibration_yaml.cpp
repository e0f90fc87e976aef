// SPDX-License-Identifier: Apache-2.0
//
// Calibrations in YAML and XML: OpenCV's files and ROS camera_info. For images so small that maps are made of what is
// accepted.
#include "calibration/formats/calibration_formats.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/rectify.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::text_of(data, size));
    const std::string path = file.path();
    const auto read = [&](auto reader) {
        fuzz::accepted("calibration " + path, [&] {
            const calibration::StereoCalibration calibration = reader();
            calibration::check_plausible(calibration, path);
            fuzz::expect_same_after_text(calibration);
            fuzz::rectify(calibration, path);
        });
    };
    read([&] { return calibration::read_opencv_calibration(path, {}, 64, 48); });
    read([&] { return calibration::read_ros_calibration(path, path, 64, 48); });
    return 0;
}
