// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/cache_size.h"

#include <fstream>
#include <string>

#include <unistd.h>

namespace disparityd::cpu {

namespace {

// 0: there is no such cache, or the system does not tell.
std::size_t cache_bytes(int index) {
    std::ifstream file("/sys/devices/system/cpu/cpu0/cache/index" + std::to_string(index) + "/size");
    std::size_t size = 0;
    char unit = 'K';
    if (!(file >> size >> unit)) {
        return 0;
    }
    return size << (unit == 'M' ? 20 : 10);
}

}  // namespace

// Not sysconf where the kernel says it: glibc 2.36 has been seen to count a cache once per thread that it thinks there
// is (335 MB where there were 32).
std::size_t last_level_cache_bytes() {
    constexpr std::size_t usual = std::size_t{8} << 20;
    constexpr int third_level = 3, second_level = 2;  // 0 and 1 are the first-level caches
    for (const int index : {third_level, second_level}) {
        if (const std::size_t found = cache_bytes(index); found > 0) {
            return found;
        }
    }
    const long found = sysconf(_SC_LEVEL3_CACHE_SIZE);
    return found > 0 ? static_cast<std::size_t>(found) : usual;
}

}  // namespace disparityd::cpu
