// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/machine.h"

#include <algorithm>
#include <fstream>

#include <sched.h>

#include "base/words.h"
#include "kernels/cpu/backend.h"
#include "kernels/cpu/cache_size.h"

namespace disparityd::bench {
namespace {

std::string processor() {
    std::ifstream facts("/proc/cpuinfo");
    const std::string key = "model name";
    for (std::string line; std::getline(facts, line);) {
        const std::size_t colon = line.find(": ");
        if (line.compare(0, key.size(), key) == 0 && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown processor";
}

std::string compiler() {
#if defined(__clang__)
    return "clang " __clang_version__;
#elif defined(__GNUC__)
    return "g++ " __VERSION__;
#else
    return "unknown compiler";
#endif
}

}  // namespace

int allowed_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return sched_getaffinity(0, sizeof set, &set) == 0 ? std::max(1, CPU_COUNT(&set)) : 1;
}

std::vector<std::string> describe_machine() {
    std::string sets;
    for (const cpu::InstructionSet& set : cpu::instruction_sets()) {
        sets += ' ' + set.name;
    }
    return {processor() + ", " + base::counted(static_cast<std::uint64_t>(allowed_cores()), "core") +
                " for this process, last-level cache " + std::to_string(cpu::last_level_cache_bytes() >> 20) +
                " MiB; instruction sets:" + (sets.empty() ? " none that ours is built for" : sets),
            "built with " + compiler()};
}

}  // namespace disparityd::bench
