// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cpu/sgm/sweep_scheduler.h"

namespace disparityd::cpu {

/// Rows first, first + direction, ..
struct SweepRows {
    int direction = 1;
    int first = 0;
    int count = 0;

    int row(int i) const { return first + i * direction; }
};

/// How the rows of an image are divided among workers.
class SweepPlan {
public:
    /// `rows_at_once` as SgmKernels has it; `workers`: how many there can be, `scratch_count`: for how many of them
    /// there is memory.
    SweepPlan(int width, int height, int rows_at_once, int workers, int scratch_count);

    /// Rows of the upper half, rounded down: the first part of the downward sweep, the second of the upward one.
    SweepScheduler::Groups groups() const;
    SweepRows rows_of(const RowGroup& group) const;

    /// After how many steps of its rows a worker says how far it is.
    int steps_at_once() const { return steps_at_once_; }

    /// A worker's next group is about so many after the one that it is at.
    int groups_ahead() const { return groups_ahead_; }

    /// What a worker is given to do at a time.
    int tasks() const { return tasks_; }
    int groups_of_task() const { return groups_of_task_; }

private:
    int groups_of_rows(int rows) const { return (rows + rows_at_once_ - 1) / rows_at_once_; }

    int height_;
    int rows_at_once_;
    int steps_at_once_;
    int groups_ahead_;
    int tasks_;
    int groups_of_task_;
};

}  // namespace disparityd::cpu
