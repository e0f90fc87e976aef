// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/stereo_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "base/number_text.h"
#include "calibration/zed_modes.h"

namespace disparityd::capture {
namespace {

struct Aspect {
    int width;
    int height;
};
constexpr std::array<Aspect, 5> usual_aspects{{{4, 3}, {16, 9}, {16, 10}, {5, 4}, {3, 2}}};

/// Rates from here on are video.
constexpr double video_rate = 24;

/// The most that is proposed: larger ones are slow to match.
constexpr int most_width = 2 * 1280;
constexpr int most_height = 960;

constexpr double proposed_rate = 30;

/// Returns the usual aspect that half of the width has, give or take a hundredth.
const Aspect* aspect_of_eye(const VideoMode& mode) {
    for (const Aspect& aspect : usual_aspects) {
        const double wanted = 2.0 * aspect.width / aspect.height;
        if (mode.height > 0 && std::abs(static_cast<double>(mode.width) / mode.height / wanted - 1) < 0.01) {
            return &aspect;
        }
    }
    return nullptr;
}

/// Returns "yuyv", "grey" or "mjpeg"; empty for a format that is not read.
std::string format_name(const VideoMode& mode) {
    if (mode.format == "YUYV") {
        return "yuyv";
    }
    if (mode.format == "GREY") {
        return "grey";
    }
    return mode.format == "MJPG" ? "mjpeg" : "";
}

/// Returns the mode's rate that is nearest to what is proposed.
double rate_of(const VideoMode& mode) {
    double best = mode.rates.empty() ? proposed_rate : mode.rates.front();
    for (const double rate : mode.rates) {
        best = std::abs(rate - proposed_rate) < std::abs(best - proposed_rate) ? rate : best;
    }
    return best;
}

/// Compares as later is better.
auto worth(const VideoMode& mode) {
    const bool fits = mode.width <= most_width && mode.height <= most_height;
    const bool fast = rate_of(mode) >= video_rate;
    const int pixels = mode.width * mode.height;
    return std::tuple(fits && fast, fast, fits ? pixels : -pixels, format_name(mode) == "yuyv",
                      format_name(mode) == "mjpeg", rate_of(mode));
}

std::string name_of(const UsbCamera& camera) {
    if (camera.zed() != nullptr && !camera.serial.empty()) {
        return "serial=" + camera.serial;
    }
    return camera.port.empty() ? "device=" + camera.node : "port=" + camera.port;
}

StereoAdvice advise_zed(const CameraSurvey& survey) {
    // USB 2 has the smallest mode only.
    const auto offers = [&](int width) {
        return std::any_of(survey.modes.begin(), survey.modes.end(),
                           [width](const VideoMode& mode) { return mode.width == width; });
    };
    const std::string name = offers(2560) ? "hd720" : "vga";
    const calibration::ZedMode& mode = *calibration::zed_mode_of_name(name);
    return {"a " + survey.camera.model(), "v4l2:" + name + "@30?" + name_of(survey.camera), mode.width, mode.height};
}

}  // namespace

std::optional<StereoAdvice> advise(const CameraSurvey& survey) {
    if (!survey.problem.empty()) {
        return std::nullopt;
    }
    if (survey.camera.zed() != nullptr) {
        return advise_zed(survey);
    }
    const VideoMode* best = nullptr;
    for (const VideoMode& mode : survey.modes) {
        const bool usable = aspect_of_eye(mode) != nullptr && !format_name(mode).empty() && mode.width % 4 == 0;
        if (usable && (best == nullptr || worth(mode) > worth(*best))) {
            best = &mode;
        }
    }
    if (best == nullptr) {
        return std::nullopt;
    }
    const Aspect& aspect = *aspect_of_eye(*best);
    const std::string size = std::to_string(best->width) + "x" + std::to_string(best->height);
    const std::string format = format_name(*best);
    return StereoAdvice{size + " is two pictures of " + std::to_string(aspect.width) + ":" +
                            std::to_string(aspect.height) + " side by side",
                        "v4l2:" + size + "@" + base::number_text(std::round(rate_of(*best) * 100) / 100) + "?" +
                            name_of(survey.camera) + (format == "yuyv" ? "" : "&format=" + format),
                        best->width / 2, best->height};
}

}  // namespace disparityd::capture
