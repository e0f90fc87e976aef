// SPDX-License-Identifier: Apache-2.0
#include "pipeline/core_allocator.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include <sched.h>

#include "pipeline/cores.h"

namespace disparityd::pipeline {

namespace {

/// Tries to set the affinity of this thread, which a filter of system calls may forbid. Returns 0 or errno.
int try_pinning() {
    cpu_set_t own;
    CPU_ZERO(&own);
    const int error = pthread_getaffinity_np(pthread_self(), sizeof own, &own);
    return error != 0 ? error : pthread_setaffinity_np(pthread_self(), sizeof own, &own);
}

/// Returns numbers as ranges, such as "0-3, 6".
std::string in_ranges(const std::vector<int>& sorted) {
    std::string text;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t last = i;
        while (last + 1 < sorted.size() && sorted[last + 1] == sorted[last] + 1) {
            ++last;
        }
        text += (text.empty() ? "" : ", ") + std::to_string(sorted[i]);
        text += last > i ? '-' + std::to_string(sorted[last]) : "";
        i = last + 1;
    }
    return text;
}

}  // namespace

CoreAllocator::CoreAllocator(int workers, bool wanted) {
    if (!wanted) {
        problem_ = "switched off";
        return;
    }
    const std::vector<int> allowed = cores_allowed();
    if (workers > static_cast<int>(allowed.size())) {
        problem_ = allowed.empty() ? "the system does not say which cores there are"
                                   : std::to_string(workers) + " workers share " + std::to_string(allowed.size()) +
                                         (allowed.size() == 1 ? " core" : " cores");
        return;
    }
    if (const int error = try_pinning(); error != 0) {
        disable(error);
        return;
    }
    for (const int core : allowed) {
        cores_.push_back({core});
    }
}

int CoreAllocator::take(int preferred, int avoided) {
    Core* best = nullptr;
    for (Core& core : cores_) {
        if (core.taken) {
            continue;
        }
        if (core.number == preferred && preferred != avoided) {
            best = &core;
            break;
        }
        if (best == nullptr || best->number == avoided) {
            best = &core;
        }
    }
    if (best == nullptr) {
        return none;
    }
    best->taken = true;
    return best->number;
}

void CoreAllocator::give_back(int number) {
    for (Core& core : cores_) {
        if (core.number == number) {
            core.taken = false;
        }
    }
}

bool CoreAllocator::is_free(int number) const {
    return std::any_of(cores_.begin(), cores_.end(),
                       [number](const Core& core) { return core.number == number && !core.taken; });
}

void CoreAllocator::disable(int error) {
    cores_.clear();
    problem_ = std::string("the system refuses it: ") + std::strerror(error);
}

std::string CoreAllocator::text() const {
    if (!pinning_enabled()) {
        return "not pinned to cores: " + problem_;
    }
    std::vector<int> numbers;
    std::transform(cores_.begin(), cores_.end(), std::back_inserter(numbers),
                   [](const Core& core) { return core.number; });
    std::sort(numbers.begin(), numbers.end());
    return "pinned, each to one of cores " + in_ranges(numbers);
}

int pin_to_core(pthread_t thread, int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(core), &set);
    return pthread_setaffinity_np(thread, sizeof set, &set);
}

}  // namespace disparityd::pipeline
