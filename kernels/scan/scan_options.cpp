// SPDX-License-Identifier: Apache-2.0
#include "kernels/scan/scan_options.h"

#include <array>
#include <cmath>
#include <sstream>

namespace disparityd {
namespace {

struct Range {
    const char* name;
    double value;
    double least;
    double most;
};

std::string number(double value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

}  // namespace

std::string validate(const ScanOptions& options) {
    const std::array ranges{
        Range{"sectors", static_cast<double>(options.sectors), 1, max_scan_sectors},
        Range{"from_deg", options.from_deg, -180, 180},
        Range{"to_deg", options.to_deg, -180, 180},
        Range{"camera_height_m", options.camera_height_m, -10, 30},
        Range{"pitch_deg", options.pitch_deg, -45, 45},
        Range{"roll_deg", options.roll_deg, -45, 45},
        Range{"yaw_deg", options.yaw_deg, -180, 180},
        Range{"low_m", options.low_m, -30, 30},
        Range{"high_m", options.high_m, -30, 30},
        Range{"min_m", options.min_m, 0.01, 60},
        Range{"max_m", options.max_m, 0.02, 65},
        Range{"object_m", options.object_m, 0.01, 10},
        Range{"max_error_m", options.max_error_m, 0.001, 65},
        Range{"subpixel_error_px", options.subpixel_error_px, 0.01, 4},
        Range{"min_confidence", static_cast<double>(options.min_confidence), 1, 255},
    };
    for (const Range& range : ranges) {
        if (!(range.value >= range.least && range.value <= range.most)) {  // not a number fails, too
            return std::string(range.name) + " = " + number(range.value) + ": allowed is " + number(range.least) +
                   " to " + number(range.most);
        }
    }
    const bool field_of_view = options.from_deg == 0 && options.to_deg == 0;
    if (!field_of_view && !(options.to_deg > options.from_deg)) {
        return "to_deg = " + number(options.to_deg) + ": allowed is more than from_deg, " + number(options.from_deg) +
               ", or 0 for both: the field of view";
    }
    if (!(options.high_m > options.low_m)) {
        return "high_m = " + number(options.high_m) + ": allowed is more than low_m, " + number(options.low_m);
    }
    if (!(options.camera_height_m >= options.low_m + 0.02)) {
        return "camera_height_m = " + number(options.camera_height_m) + ": allowed is at least 0.02 more than low_m, " +
               number(options.low_m);
    }
    if (!(options.max_m > options.min_m)) {
        return "max_m = " + number(options.max_m) + ": allowed is more than min_m, " + number(options.min_m);
    }
    return {};
}

}  // namespace disparityd
