// SPDX-License-Identifier: Apache-2.0
#include "pipeline/cores.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string_view>
#include <thread>
#include <utility>

#include <sched.h>

namespace disparityd::pipeline {

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
    const std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Returns how many of `cores` with a smaller number share the physical core of `core`; 0 where the system does not
/// say.
std::ptrdiff_t earlier_siblings(int core, const std::vector<int>& cores) {
    // The file holds "0,20" or "0-1".
    std::istringstream list(
        text_of("/sys/devices/system/cpu/cpu" + std::to_string(core) + "/topology/thread_siblings_list"));
    std::ptrdiff_t earlier = 0;
    int first = 0;
    while (list >> first) {
        int last = first;
        if (list.peek() == '-') {
            list.ignore();
            list >> last;
        }
        earlier += std::count_if(cores.begin(), cores.end(),
                                 [=](int other) { return other >= first && other <= last && other < core; });
        list.ignore();
    }
    return earlier;
}

/// Returns a limit of time in cores, rounded up: "150000 100000" gives 2, "max 100000" (no limit) gives 0.
int cores_of(const std::string& limit) {
    std::istringstream text(limit);
    long long quota = 0, period = 0;
    if (!(text >> quota >> period) || quota <= 0 || period <= 0) {
        return 0;
    }
    return static_cast<int>(std::min<long long>((quota - 1) / period + 1, std::numeric_limits<int>::max()));
}

}  // namespace

std::vector<int> cores_allowed() {
    std::vector<int> cores;
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return cores;
    }
    for (int core = 0; core < CPU_SETSIZE; ++core) {
        if (CPU_ISSET(core, &set)) {
            cores.push_back(core);
        }
    }
    std::vector<std::pair<std::ptrdiff_t, int>> order;
    std::transform(cores.begin(), cores.end(), std::back_inserter(order),
                   [&](int core) { return std::pair(earlier_siblings(core, cores), core); });
    std::sort(order.begin(), order.end());
    std::transform(order.begin(), order.end(), cores.begin(), [](const auto& entry) { return entry.second; });
    return cores;
}

int quota_of(const std::string& groups, const std::string& root) {
    constexpr std::string_view unified = "0::";
    std::istringstream lines(groups);
    int least = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with(unified)) {
            continue;
        }
        fs::path group = fs::path(line.substr(unified.size())).relative_path();
        for (bool more = true; more; group = group.parent_path()) {
            more = !group.empty();
            const int limit = cores_of(text_of(root / group / "cpu.max"));
            least = least == 0 ? limit : limit == 0 ? least : std::min(least, limit);
        }
    }
    return least;
}

int cores_worth() {
    const int allowed = static_cast<int>(cores_allowed().size());
    const int cores = allowed > 0 ? allowed : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const int quota = quota_of(text_of("/proc/self/cgroup"), "/sys/fs/cgroup");
    return quota > 0 ? std::min(cores, quota) : cores;
}

}  // namespace disparityd::pipeline
