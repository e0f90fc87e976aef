// SPDX-License-Identifier: Apache-2.0
#include "daemon/measured_watch.h"

#include <fmt/format.h>

#include "calibration/empty_result/empty_result.h"
#include "daemon/log.h"
#include "kernels/near_plane.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

using empty_result::EmptyResult;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds count_interval{250};
constexpr std::chrono::seconds look_interval{5};
/// So much of the image is told when it is too near, and again after less than that was.
constexpr double much_near = 0.1;
constexpr double little_near = 0.05;

double near_share(Plane<const std::int16_t> near) {
    return near ? static_cast<double>(near_count(near)) / (static_cast<double>(near.width) * near.height) : 0;
}

}  // namespace

MeasuredWatch::MeasuredWatch(int width, int height, DisparityRange range,
                             const std::optional<calibration::StereoCalibration>& calibration)
    : range_(range),
      calibration_(calibration),
      pairs_("likely-cause", width, height, look_interval, [this](auto left, auto right) { look(left, right); }) {}

void MeasuredWatch::offer(const pipeline::FrameSlot& slot) noexcept {
    const auto now = steady_clock::now();
    if (now < next_count_) {
        return;
    }
    next_count_ = now + count_interval;
    const Plane<const std::uint8_t> confidence = slot.view.confidence;
    const double share = static_cast<double>(empty_result::measured_pixels(confidence)) /
                         (static_cast<double>(confidence.width) * confidence.height);
    near_.store(near_share(slot.view.near));
    share_.store(share);
    if (share >= EmptyResult::suspicious_below) {
        has_cause_.store(false);
    } else if (pairs_.wants()) {
        pairs_.give(slot.view);
    }
}

void MeasuredWatch::look(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    const empty_result::LikelyCause found = empty_result::likely_cause({left, right, range_, calibration_});
    const double share = share_.load();
    const bool told = EmptyResult::is_told(found, share);
    {
        const std::lock_guard lock(mutex_);
        cause_ = told ? found.text : "";
    }
    if (!has_cause_.exchange(true) && told) {
        log_warning(
            fmt::format("only {:.1f} % of the pixels are measured; the likely cause: {}", 100 * share, found.text));
    }
}

std::optional<MeasuredWatch::Finding> MeasuredWatch::finding() const {
    const double share = share_.load();
    if (share < 0) {
        return std::nullopt;
    }
    const std::lock_guard lock(mutex_);
    return Finding{share, near_.load(), has_cause_.load() ? proto::to_valid_utf8(cause_) : ""};
}

std::string MeasuredWatch::near_line() {
    const double share = near_.load();
    if (share < little_near) {
        near_told_ = false;
    }
    if (share < much_near || near_told_) {
        return {};
    }
    near_told_ = true;
    return fmt::format(
        "{:.0f} % of the image is nearer than can be measured: more [match] disparities or a smaller image measure "
        "nearer "
        "things",
        100 * share);
}

}  // namespace disparityd::daemon
