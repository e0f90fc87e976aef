// SPDX-License-Identifier: Apache-2.0
#include "pipeline/core_allocator.h"

#include <algorithm>
#include <cstring>

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

CoreAllocator::CoreAllocator(int workers, bool wanted) : workers_(workers) {
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
    allowed_ = allowed;
    cores_.reserve(allowed_.size());
}

int CoreAllocator::missing() const {
    const auto lent = std::count_if(cores_.begin(), cores_.end(), [](const Core& core) { return !core.withdrawn; });
    return pinning_enabled() ? std::max(0, workers_ - static_cast<int>(lent)) : 0;
}

CoreAllocator::Core* CoreAllocator::find(int number) {
    const auto core =
        std::find_if(cores_.begin(), cores_.end(), [number](const Core& each) { return each.number == number; });
    return core == cores_.end() ? nullptr : &*core;
}

void CoreAllocator::add(int number) {
    if (!pinning_enabled()) {
        return;
    }
    if (Core* core = find(number); core != nullptr) {
        core->withdrawn = false;
    } else {
        cores_.push_back({number});
    }
}

void CoreAllocator::withdraw(int number) {
    if (Core* core = find(number); core != nullptr && core->taken) {
        core->withdrawn = true;
    } else if (core != nullptr) {
        cores_.erase(cores_.begin() + (core - cores_.data()));
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
    if (Core* core = find(number); core != nullptr) {
        core->taken = false;
        if (core->withdrawn) {
            withdraw(number);
        }
    }
}

int CoreAllocator::pass_on(int number) {
    give_back(number);
    return take(number, none);
}

bool CoreAllocator::is_free(int number) const {
    return std::any_of(cores_.begin(), cores_.end(),
                       [number](const Core& core) { return core.number == number && !core.taken; });
}

void CoreAllocator::disable(int error) {
    allowed_.clear();
    cores_.clear();
    problem_ = std::string("the system refuses it: ") + std::strerror(error);
}

std::string CoreAllocator::text() const {
    if (!pinning_enabled()) {
        return "not pinned to cores: " + problem_;
    }
    std::vector<int> numbers;
    for (const Core& core : cores_) {
        if (!core.withdrawn) {
            numbers.push_back(core.number);
        }
    }
    std::sort(numbers.begin(), numbers.end());
    if (numbers.empty()) {
        return "not pinned to cores: " + (why_missing_.empty() ? "nothing is matched now" : why_missing_);
    }
    const int without = missing();
    return without == 0 ? "pinned, each to one of cores " + in_ranges(numbers)
                        : "pinned to cores " + in_ranges(numbers) + ", but for " + std::to_string(without) + " of " +
                              std::to_string(workers_) + ": " + why_missing_;
}

int pin_to_core(pthread_t thread, int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(core), &set);
    return pthread_setaffinity_np(thread, sizeof set, &set);
}

}  // namespace disparityd::pipeline
