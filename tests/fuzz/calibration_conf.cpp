// SPDX-License-Identifier: Apache-2.0
//
// Calibrations that are plain text: a factory .conf and those of the data sets.
#include "calibration/formats/calibration_formats.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/rectify.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(fuzz::text_of(data, size));
    const auto read = [&](auto reader) {
        fuzz::accepted("calibration input", [&] {
            const calibration::StereoCalibration calibration = reader();
            calibration::check_plausible(calibration, "input");
            fuzz::expect_same_after_text(calibration);
        });
    };
    read([&] { return calibration::read_factory_conf("input", text, 672, 376); });
    read([&] { return calibration::read_factory_conf("input", text, 1280, 720); });
    read([&] { return calibration::read_factory_conf("input", text, 1920, 1200); });
    read([&] { return calibration::read_middlebury_calibration("input", text, 640, 480); });
    read([&] { return calibration::read_kitti_calibration("input", text, 0, 640, 480); });
    fuzz::accepted("calibration input", [&] { calibration::kitti_camera("input", text, std::nullopt); });
    return 0;
}
