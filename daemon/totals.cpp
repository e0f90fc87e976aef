// SPDX-License-Identifier: Apache-2.0
#include "daemon/totals.h"

#include <algorithm>

namespace disparityd::daemon {
namespace {

void add_step(v1::Totals& totals, const v1::StepTotal& before) {
    auto& steps = *totals.mutable_steps();
    const auto same =
        std::find_if(steps.begin(), steps.end(), [&](const auto& step) { return step.name() == before.name(); });
    if (same == steps.end()) {
        *totals.add_steps() = before;
        return;
    }
    same->set_count(same->count() + before.count());
    same->set_sum_ns(same->sum_ns() + before.sum_ns());
    for (int i = 0; i < std::min(same->up_to_size(), before.up_to_size()); ++i) {
        same->set_up_to(i, same->up_to(i) + before.up_to(i));
    }
}

}  // namespace

void put_steps(v1::Totals& totals, const std::vector<pipeline::PipelineStatus::Step>& steps) {
    const auto& bounds = pipeline::duration_bounds_us;
    totals.mutable_bounds_us()->Assign(bounds.begin(), bounds.end());
    totals.clear_steps();
    for (const auto& step : steps) {
        v1::StepTotal& total = *totals.add_steps();
        total.set_name(step.name);
        total.set_count(step.totals.count);
        total.set_sum_ns(step.totals.sum_ns);
        total.mutable_up_to()->Assign(step.totals.up_to.begin(), step.totals.up_to.end());
    }
}

void add_totals(v1::Totals& totals, const v1::Totals& before) {
    totals.set_captured(totals.captured() + before.captured());
    totals.set_published(totals.published() + before.published());
    totals.set_dropped(totals.dropped() + before.dropped());
    totals.set_lost(totals.lost() + before.lost());
    totals.set_damaged(totals.damaged() + before.damaged());
    totals.set_unwanted(totals.unwanted() + before.unwanted());
    totals.set_over_budget(totals.over_budget() + before.over_budget());
    if (totals.bounds_us_size() == 0) {
        *totals.mutable_bounds_us() = before.bounds_us();
    }
    for (const v1::StepTotal& step : before.steps()) {
        add_step(totals, step);
    }
}

}  // namespace disparityd::daemon
