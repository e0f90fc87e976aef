// SPDX-License-Identifier: Apache-2.0
#include "pipeline/core_places.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#include <sched.h>

#include "pipeline/cores.h"

namespace disparityd::pipeline {

namespace {

/// Whether this thread may change where it runs: a filter of system calls may forbid it.
int try_binding() {
    cpu_set_t own;
    CPU_ZERO(&own);
    const int error = pthread_getaffinity_np(pthread_self(), sizeof own, &own);
    return error != 0 ? error : pthread_setaffinity_np(pthread_self(), sizeof own, &own);
}

/// "0-3, 6"
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

CorePlaces::CorePlaces(int workers, bool wanted) {
    if (!wanted) {
        problem_ = "switched off";
        return;
    }
    const std::vector<int> cores = cores_allowed();
    if (workers > static_cast<int>(cores.size())) {
        problem_ = cores.empty() ? "the system does not say which cores there are"
                                 : std::to_string(workers) + " workers share " + std::to_string(cores.size()) +
                                       (cores.size() == 1 ? " core" : " cores");
        return;
    }
    if (const int error = try_binding(); error != 0) {
        refused(error);
        return;
    }
    for (const int core : cores) {
        places_.push_back({core});
    }
}

int CorePlaces::take(int preferred, int avoided) {
    Place* best = nullptr;
    for (Place& place : places_) {
        if (place.taken) {
            continue;
        }
        if (place.core == preferred && preferred != avoided) {
            best = &place;
            break;
        }
        if (best == nullptr || best->core == avoided) {
            best = &place;
        }
    }
    if (best == nullptr) {
        return none;
    }
    best->taken = true;
    return best->core;
}

void CorePlaces::give_back(int core) {
    for (Place& place : places_) {
        if (place.core == core) {
            place.taken = false;
        }
    }
}

bool CorePlaces::is_free(int core) const {
    return std::any_of(places_.begin(), places_.end(),
                       [core](const Place& place) { return place.core == core && !place.taken; });
}

void CorePlaces::refused(int error) {
    places_.clear();
    problem_ = std::string("the system refuses it: ") + std::strerror(error);
}

std::string CorePlaces::text() const {
    if (!bound()) {
        return "not pinned to cores: " + problem_;
    }
    std::vector<int> cores;
    std::transform(places_.begin(), places_.end(), std::back_inserter(cores),
                   [](const Place& place) { return place.core; });
    std::sort(cores.begin(), cores.end());
    return "pinned, each to one of cores " + in_ranges(cores);
}

int bind_to_core(pthread_t thread, int core) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(core), &set);
    return pthread_setaffinity_np(thread, sizeof set, &set);
}

}  // namespace disparityd::pipeline
