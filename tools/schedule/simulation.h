// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/cpu/sgm/sweep_plan.h"

namespace disparityd::schedule {

/// What the parts of a group of rows take, in microseconds.
struct TaskTimes {
    double costs = 0;          ///< matching costs of its rows
    double aggregate[2] = {};  ///< its paths, first and second part of a sweep
    double winners = 0;
};

/// An image and how its sweeps are divided.
struct Division {
    int width = 0;
    int rows_at_once = 1;
    cpu::SweepPlan plan;
};

/// How long SgmSweeps::match() takes with this many workers, each with a core of its own and all as fast as the one
/// that the times come from: groups are taken as SweepScheduler gives them, rows wait for each other as SgmSweeps has
/// it, everything else takes no time. In microseconds.
double simulate(const Division& division, const TaskTimes& times, int workers);

}  // namespace disparityd::schedule
