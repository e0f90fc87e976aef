// SPDX-License-Identifier: Apache-2.0
// Asking for memory before it is needed.
#if defined(DISPARITYD_CPU_SIMD_PREFETCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SIMD_PREFETCH_INL_H_
#undef DISPARITYD_CPU_SIMD_PREFETCH_INL_H_
#else
#define DISPARITYD_CPU_SIMD_PREFETCH_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "kernels/cpu/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

constexpr int cache_line = 64;

/// What is needed a row later would only push what is needed now out of the first-level cache.
HWY_INLINE void prefetch_to_second_level(const std::uint8_t* from) {
    constexpr int reading = 0;
    constexpr int second_level = 2;
    __builtin_prefetch(from, reading, second_level);
}

struct Memory {
    const std::uint8_t* from;
    std::size_t bytes;
};

/// Asks for memory in `portions` equal parts of whole lines, and so perhaps for a little of what follows it.
class Prefetch {
public:
    Prefetch(Memory memory, int portions)
        : at_(memory.from), lines_(static_cast<int>(memory.bytes / cache_line) / portions + 1) {}

    HWY_INLINE void portion() {
        for (int i = 0; i < lines_; ++i) {
            prefetch_to_second_level(at_);
            at_ += cache_line;
        }
    }

private:
    const std::uint8_t* at_;
    int lines_;
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
