// SPDX-License-Identifier: Apache-2.0
#include "base/freed_memory.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace disparityd::base {

void set_up_freed_memory() {
#ifdef __GLIBC__
    constexpr int mapping_bytes = 4 << 20;
    constexpr int heaps = 4;
    mallopt(M_MMAP_THRESHOLD, mapping_bytes);
    mallopt(M_ARENA_MAX, heaps);
#endif
}

void give_back_freed_memory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

}  // namespace disparityd::base
