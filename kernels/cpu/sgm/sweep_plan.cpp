// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sweep_plan.h"

#include <algorithm>

#include "kernels/cpu/sgm/sgm_kernels.h"
#include "kernels/steps.h"

namespace disparityd::cpu {

namespace {

// How far rows are behind those before them when all report after so many steps.
int distance(int steps, int rows_at_once) {
    int ahead = steps;
    while (done_after(ahead, max_side, rows_at_once) <= 0) {
        ahead += steps;
    }
    return steps + ahead;
}

// With one worker in a sweep nobody asks before the end of a row. With many, there must be room for all that are not at
// costs or winners, about three of five; but each report takes as long as a few pixels.
int steps_between_reports(int width, int rows_at_once, int workers) {
    if (workers <= 2) {
        return steps_of(width, rows_at_once);
    }
    const int workers_in_sweep = (workers + 1) / 2;
    int steps = 8 * min_block;
    while (steps > min_block && 3 * workers_in_sweep * distance(steps, rows_at_once) > 5 * width) {
        steps -= min_block;
    }
    return steps;
}

}  // namespace

SweepPlan::SweepPlan(int width, int height, int rows_at_once, int workers, int scratch_count)
    : height_(height),
      rows_at_once_(rows_at_once),
      steps_at_once_(steps_between_reports(width, rows_at_once, workers)),
      groups_ahead_((workers + 1) / 2) {
    constexpr int max_groups_of_task = 16;
    const SweepScheduler::Groups all = groups();
    const int count = all[0][0] + all[0][1] + all[1][0] + all[1][1];
    if (workers > scratch_count) {
        tasks_ = scratch_count;
        groups_of_task_ = count;
    } else {
        // Between two tasks a worker can turn to what is more urgent.
        groups_of_task_ = std::clamp(count / (8 * workers), 1, max_groups_of_task);
        tasks_ = (count + groups_of_task_ - 1) / groups_of_task_;
    }
}

SweepScheduler::Groups SweepPlan::groups() const {
    const int upper = groups_of_rows(height_ / 2);
    const int lower = groups_of_rows(height_ - height_ / 2);
    return {{{upper, lower}, {lower, upper}}};
}

SweepRows SweepPlan::rows_of(const RowGroup& group) const {
    const int rows_of_first_part = group.sweep == 0 ? height_ / 2 : height_ - height_ / 2;
    // Counted in the direction of the sweep.
    int first = group.index * rows_at_once_;
    int end = rows_of_first_part;
    if (group.part == 1) {
        first = rows_of_first_part + (group.index - groups_of_rows(rows_of_first_part)) * rows_at_once_;
        end = height_;
    }
    const int count = std::min(rows_at_once_, end - first);
    return group.sweep == 0 ? SweepRows{1, first, count} : SweepRows{-1, height_ - 1 - first, count};
}

}  // namespace disparityd::cpu
