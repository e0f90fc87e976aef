// SPDX-License-Identifier: Apache-2.0
//
// Calibrations that are plain text: a factory .conf and those of the data sets.
#include "capture/calibration_formats.h"
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/rectify.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(fuzz::text_of(data, size));
    const auto read = [&](auto reader) {
        fuzz::accepted("calibration input", [&] {
            const capture::StereoCalibration calibration = reader();
            capture::check_plausible(calibration, "input");
            fuzz::expect_same_after_text(calibration);
        });
    };
    read([&] { return capture::read_factory_conf("input", text, 672, 376); });
    read([&] { return capture::read_factory_conf("input", text, 1280, 720); });
    read([&] { return capture::read_middlebury_calibration("input", text, 640, 480); });
    read([&] { return capture::read_kitti_calibration("input", text, 0, 640, 480); });
    return 0;
}
