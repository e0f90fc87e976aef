// SPDX-License-Identifier: Apache-2.0
#include "daemon/measured_watch.h"

#include <fmt/format.h>

#include "calibration/empty_result/empty_result.h"
#include "daemon/log.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

using empty_result::EmptyResult;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds count_interval{250};
constexpr std::chrono::seconds look_interval{5};

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
    return Finding{share, has_cause_.load() ? proto::to_valid_utf8(cause_) : ""};
}

}  // namespace disparityd::daemon
