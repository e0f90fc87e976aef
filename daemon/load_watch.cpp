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

std::string text_of(const FrameRates& rates) {
    return fmt::format("{:.1f} frames/s come, {}{:.1f} are matched", rates.come, rates.at_most ? "at most " : "",
                       rates.matched);
}

}  // namespace

bool LoadWatch::is_due(Time now) const {
    return !told_ && (!window_ || now >= window_->begin + window_length);
}

std::string LoadWatch::check(std::uint64_t came, std::uint64_t matched, std::uint64_t over_budget, Time now) {
    if (!is_due(now)) {
        return {};
    }
    if (!window_) {
        window_ = {now, came, matched, over_budget};
        return {};
    }
    const double seconds = std::chrono::duration<double>(now - window_->begin).count();
    const double came_rate = static_cast<double>(came - window_->came) / seconds;
    const double matched_rate = static_cast<double>(matched - window_->matched) / seconds;
    // Most of the frames that are missing tell why.
    const bool for_budget =
        2 * (over_budget - window_->over_budget) > came - window_->came - (matched - window_->matched);
    window_ = {now, came, matched, over_budget};
    constexpr double kept = 0.95;
    // Where none is matched, something else is wrong, unless the budget says that it is the reason.
    const bool is_load = matched_rate > 0 || for_budget;
    overloaded_ = is_load && matched_rate < kept * came_rate ? overloaded_ + 1 : 0;
    if (overloaded_ < windows_in_a_row) {
        return {};
    }
    told_ = true;
    const FrameRates rates{came_rate, matched_rate};
    return for_budget && are_hardly_any(rates)
               ? budget_leaves_little(rates, budget_)
               : slower_than_the_source(rates, width_, height_, disparities_, for_budget ? budget_ : 0);
}

bool are_hardly_any(const FrameRates& rates) {
    constexpr double hardly_any = 0.05;
    return rates.matched < hardly_any * rates.come;
}

std::string slower_than_the_source(const FrameRates& rates, int width, int height, int disparities, double budget) {
    constexpr double spare = 0.9;  // nobody's work is the same for each frame
    const double share = spare * rates.matched / rates.come;
    constexpr int step = 16;
    constexpr int min_side = 64;
    const std::string why = budget > 0 ? fmt::format("[pipeline] cores = {} is less than matching needs", budget)
                                       : "matching is slower than the source";
    std::string line =
        fmt::format("{}: {}, the others are {}", why, text_of(rates), budget > 0 ? "left out" : "dropped");
    const int fewer = static_cast<int>(share * disparities) / step * step;
    const auto side = [&](int length) { return static_cast<int>(std::sqrt(share) * length) / 8 * 8; };
    const std::string smaller = std::min(side(width), side(height)) >= min_side
                                    ? fmt::format("[rectify] width = {} and height = {}", side(width), side(height))
                                    : "";
    if (fewer >= step) {
        line += fmt::format(": about [match] disparities = {} would fit", fewer);
        return smaller.empty() ? line : line + ", or " + smaller;
    }
    return smaller.empty() ? line : line + ": about " + smaller + " would fit";
}

std::string budget_leaves_little(const FrameRates& rates, double budget) {
    return fmt::format(
        "[pipeline] cores = {} leaves hardly any time for matching: {}, the others are left out: the rest of the "
        "daemon (decoding, recording, clients) takes it, or each frame costs seconds of it: give more cores",
        budget, text_of(rates));
}

}  // namespace disparityd::daemon
