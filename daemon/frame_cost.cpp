// SPDX-License-Identifier: Apache-2.0
#include "daemon/frame_cost.h"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/load_watch.h"

namespace disparityd::daemon {
namespace {

constexpr double ms = 1000;  // in a second

/// Says what counts against the budget, and what is not known.
std::string counted(const FrameCost& cost) {
    const std::string work = fmt::format("a frame takes {:.1f} ms of processor time from rectification to publication",
                                         ms * cost.used.count());
    return cost.taken ? fmt::format("{} and {:.1f} ms to be read; clients, recordings and self-calibration come on top",
                                    work, ms * cost.taken->count())
                      : work + "; its capture, clients, recordings and self-calibration come on top";
}

std::string budget_text(const FrameCost& cost, const FrameLoad& load) {
    const double most = most_in_budget(cost, load);
    if (!load.leaves_out || load.rate <= 0) {
        return fmt::format("[pipeline] cores = {} lets at most {:.1f} frames/s pass: {}", load.budget, most,
                           counted(cost));
    }
    if (const FrameRates rates{load.rate, most, true}; most < load.rate) {
        return (are_hardly_any(rates)
                    ? budget_leaves_little(rates, load.budget)
                    : slower_than_the_source(rates, load.width, load.height, load.disparities, load.budget)) +
               "; " + counted(cost);
    }
    return fmt::format("[pipeline] cores = {} allows at most {:.1f} frames/s, {:.1f} come: {}", load.budget, most,
                       load.rate, counted(cost));
}

std::string text_of(const FrameCost& cost, const FrameLoad& load) {
    const double fastest = 1 / cost.passes.count();
    if (load.leaves_out && load.rate > fastest && (load.budget <= 0 || fastest < most_in_budget(cost, load))) {
        return slower_than_the_source({load.rate, fastest}, load.width, load.height, load.disparities);
    }
    if (load.budget > 0) {
        return budget_text(cost, load);
    }
    return fmt::format("computing takes {:.1f} ms a frame {} here", ms * cost.passes.count(),
                       cost.of_source ? "of the source" : "of noise");
}

}  // namespace

double most_in_budget(const FrameCost& cost, const FrameLoad& load) {
    const double taken = cost.taken.value_or(FrameCost::Seconds(0)).count();
    if (!load.leaves_out || load.rate <= 0) {
        return load.budget / (cost.used.count() + taken);
    }
    return std::max(0.0, load.budget - load.rate * taken) / cost.used.count();
}

std::string cost_text(const FrameCost& cost, const FrameLoad& load) {
    return (cost.unread.empty() ? "" : "no frame of the source can be read: " + cost.unread + "; ") +
           text_of(cost, load);
}

}  // namespace disparityd::daemon
