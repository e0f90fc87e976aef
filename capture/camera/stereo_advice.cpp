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

/// The most that is proposed for an eye: larger ones are slow to match.
constexpr int most_width = 1280;
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

/// Compares as later is better. `eyes` are those in a frame.
auto worth(const VideoMode& mode, int eyes) {
    const bool fits = mode.width <= eyes * most_width && mode.height <= most_height;
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

std::string size_of(const VideoMode& mode) {
    return std::to_string(mode.width) + "x" + std::to_string(mode.height);
}

/// Returns "v4l2:SIZE@RATE?CAMERAS" and the format, where it must be said.
std::string uri_of(const VideoMode& mode, const std::string& cameras) {
    const std::string format = format_name(mode);
    return "v4l2:" + size_of(mode) + "@" + base::number_text(std::round(rate_of(mode) * 100) / 100) + "?" + cameras +
           (format == "yuyv" ? "" : "&format=" + format);
}

/// Whether the camera may be one of two eyes.
bool may_be_an_eye(const CameraSurvey& survey) {
    return survey.problem.empty() && survey.camera.zed() == nullptr && !advise(survey);
}

bool alike(const UsbCamera& a, const UsbCamera& b) {
    return a.name == b.name && a.vendor == b.vendor && a.product == b.product && a.bus == b.bus;
}

/// Returns the best mode that both offer, or nullptr.
const VideoMode* common_mode(const CameraSurvey& left, const CameraSurvey& right) {
    const VideoMode* best = nullptr;
    for (const VideoMode& mode : left.modes) {
        const bool both = std::any_of(right.modes.begin(), right.modes.end(), [&mode](const VideoMode& other) {
            return other.format == mode.format && other.width == mode.width && other.height == mode.height;
        });
        const bool usable = both && !format_name(mode).empty() && mode.width % 4 == 0;
        if (usable && (best == nullptr || worth(mode, 1) > worth(*best, 1))) {
            best = &mode;
        }
    }
    return best;
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
        if (usable && (best == nullptr || worth(mode, 2) > worth(*best, 2))) {
            best = &mode;
        }
    }
    if (best == nullptr) {
        return std::nullopt;
    }
    const Aspect& aspect = *aspect_of_eye(*best);
    return StereoAdvice{size_of(*best) + " is two pictures of " + std::to_string(aspect.width) + ":" +
                            std::to_string(aspect.height) + " side by side",
                        uri_of(*best, name_of(survey.camera)), best->width / 2, best->height};
}

std::vector<PairAdvice> advise_pairs(const std::vector<CameraSurvey>& surveys) {
    std::vector<PairAdvice> pairs;
    for (std::size_t left = 0; left < surveys.size(); ++left) {
        std::vector<std::size_t> like_it;
        for (std::size_t i = 0; i < surveys.size(); ++i) {
            if (may_be_an_eye(surveys[i]) && alike(surveys[i].camera, surveys[left].camera)) {
                like_it.push_back(i);
            }
        }
        if (like_it.size() != 2 || like_it.front() != left) {
            continue;
        }
        const std::size_t right = like_it.back();
        const VideoMode* mode = common_mode(surveys[left], surveys[right]);
        if (mode == nullptr) {
            continue;
        }
        const UsbCamera& a = surveys[left].camera;
        const UsbCamera& b = surveys[right].camera;
        const bool by_port = !a.port.empty() && !b.port.empty() && a.port != b.port;
        const std::string cameras =
            by_port ? "left=port:" + a.port + "&right=port:" + b.port : "left=" + a.node + "&right=" + b.node;
        pairs.push_back({{"both are " + a.model() + " and offer " + size_of(*mode), uri_of(*mode, cameras), mode->width,
                          mode->height},
                         left,
                         right});
    }
    return pairs;
}

}  // namespace disparityd::capture
