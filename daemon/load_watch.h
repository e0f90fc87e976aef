// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace disparityd::daemon {

/// Frames per second.
struct FrameRates {
    double come = 0;
    double matched = 0;
    bool at_most = false;  ///< no more than `matched` are matched; false: so many were
};

/// Whether so few of the frames that come are matched that no other size or number of disparities would help.
bool are_hardly_any(const FrameRates& rates);

/// Returns a line for people: so many frames come and are matched, and about which number of disparities or size (of
/// these as configured) would fit. `budget`: of [pipeline] cores, which is why; 0: matching takes too long.
std::string slower_than_the_source(const FrameRates& rates, int width, int height, int disparities, double budget = 0);

/// Returns a line for people: so many frames come and hardly any are matched, because of `budget`, of [pipeline] cores.
/// It names no size: where other work takes the budget, none would fit.
std::string budget_leaves_little(const FrameRates& rates, double budget);

/// Notices when matching takes longer than the source's frames are apart, or more processor time than it may have, so
/// that frames are dropped all the time. One thread.
class LoadWatch {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// As configured: the size of the frames, how many disparities are searched, and [pipeline] cores (0 = all).
    LoadWatch(int width, int height, int disparities, double budget = 0)
        : width_(width), height_(height), disparities_(disparities), budget_(budget) {}

    /// Returns whether check() would look at the numbers now: it does so at intervals, and no more once it has told.
    bool is_due(Time now) const;

    /// Takes the numbers of frames since the start: those that came to be matched, those that were, and those of the
    /// others that were left out to keep the budget. Returns, once, a line for people with the number of disparities or
    /// the size that would fit, when more than one of twenty frames is dropped for 30 s; else an empty text. Where none
    /// is matched it tells only of a budget that is the reason.
    std::string check(std::uint64_t came, std::uint64_t matched, std::uint64_t over_budget, Time now);

private:
    struct Window {
        Time begin;
        std::uint64_t came = 0;
        std::uint64_t matched = 0;
        std::uint64_t over_budget = 0;
    };

    const int width_;
    const int height_;
    const int disparities_;
    const double budget_;
    std::optional<Window> window_;
    int overloaded_ = 0;  ///< windows in a row
    bool told_ = false;
};

}  // namespace disparityd::daemon
