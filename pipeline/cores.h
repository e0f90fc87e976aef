// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace disparityd::pipeline {

/// The cores that this thread may run on: what the affinity mask and the cpuset leave (sched_getaffinity knows both),
/// by the system's numbers. Cores that share one physical core with an earlier one come last. Empty when the system
/// does not say.
std::vector<int> cores_allowed();

/// How many threads the process can keep running: cores_allowed(), or fewer where a control group limits its share of
/// time (cpu.max of version 2, of the process's group and those above it). At least 1.
int cores_worth();

/// The least limit of the groups, in cores and rounded up, 0 = none. `groups` is the text of /proc/self/cgroup, `root`
/// the folder where the hierarchy is mounted.
int quota_of(const std::string& groups, const std::string& root);

}  // namespace disparityd::pipeline
