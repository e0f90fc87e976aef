// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace disparityd::pipeline {

/// Returns the cores that this thread may run on, by the system's numbers: what the affinity mask and the cpuset leave
/// (sched_getaffinity knows both). Cores that share one physical core with an earlier one come last. Returns nothing
/// when the system does not say.
std::vector<int> cores_allowed();

/// Returns how many threads the process can keep running, at least 1: the number of cores_allowed(), or less where a
/// control group limits the share of time (cpu.max of version 2, of the process's group and those above it).
int cores_worth();

/// Returns the lowest limit of the groups in cores, rounded up; 0 = none. `groups` is the text of /proc/self/cgroup,
/// `root` the folder where the hierarchy is mounted.
int quota_of(const std::string& groups, const std::string& root);

}  // namespace disparityd::pipeline
