// SPDX-License-Identifier: Apache-2.0
#include "daemon/load_watch.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace disparityd::daemon {
namespace {

constexpr std::chrono::seconds window_length{10};
/// A trouble that is shorter than a window lies in two at most: it may be a machine that was busy with something else
/// for a moment.
constexpr int windows_in_a_row = 3;

}  // namespace

std::string LoadWatch::check(std::uint64_t captured, std::uint64_t published, Time now) {
    if (told_) {
        return {};
    }
    if (!window_) {
        window_ = {now, captured, published};
    }
    if (now < window_->begin + window_length) {
        return {};
    }
    const double seconds = std::chrono::duration<double>(now - window_->begin).count();
    const double captured_rate = static_cast<double>(captured - window_->captured) / seconds;
    const double published_rate = static_cast<double>(published - window_->published) / seconds;
    window_ = {now, captured, published};
    constexpr double kept = 0.95;
    overloaded_ = published_rate > 0 && published_rate < kept * captured_rate ? overloaded_ + 1 : 0;
    if (overloaded_ < windows_in_a_row) {
        return {};
    }
    told_ = true;
    return slower_than_the_source(captured_rate, published_rate, width_, height_, disparities_);
}

std::string slower_than_the_source(double captured_rate, double published_rate, int width, int height,
                                   int disparities) {
    constexpr double spare = 0.9;  // nobody's work is the same for each frame
    const double share = spare * published_rate / captured_rate;
    constexpr int step = 16;
    constexpr int least_side = 64;
    std::string line = fmt::format(
        "matching is slower than the source: {:.1f} frames/s come, {:.1f} are matched, the others are dropped",
        captured_rate, published_rate);
    const int fewer = static_cast<int>(share * disparities) / step * step;
    const auto side = [&](int length) { return static_cast<int>(std::sqrt(share) * length) / 8 * 8; };
    const std::string smaller = std::min(side(width), side(height)) >= least_side
                                    ? fmt::format("[rectify] width = {} and height = {}", side(width), side(height))
                                    : "";
    if (fewer >= step) {
        line += fmt::format(": about [match] disparities = {} would fit", fewer);
        return smaller.empty() ? line : line + ", or " + smaller;
    }
    return smaller.empty() ? line : line + ": about " + smaller + " would fit";
}

}  // namespace disparityd::daemon
