// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vector_peak.h"

#define HWY_TARGET_INCLUDE "tools/bench/vector_peak.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#define DISPARITYD_BENCH_VECTORS (HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128)
#if DISPARITYD_BENCH_VECTORS

#undef DISPARITYD_OPAQUE
#undef DISPARITYD_ADVANCE
// Says that a register may have changed, so that no operation on it is left out.
#if HWY_ARCH_X86
#define DISPARITYD_OPAQUE(v) asm volatile("" : "+v"((v).raw))
#else
#define DISPARITYD_OPAQUE(v) asm volatile("" : "+w"((v).raw))
#endif

#define DISPARITYD_ADVANCE(least, sum)   \
    do {                                 \
        (least) = hn::Min(least, limit); \
        (sum) = hn::Add(sum, limit);     \
        DISPARITYD_OPAQUE(least);        \
        DISPARITYD_OPAQUE(sum);          \
    } while (false)

HWY_BEFORE_NAMESPACE();
namespace disparityd::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// As many chains of dependent operations as keep every execution unit busy. Single variables: compilers keep the
// elements of an array in memory here.
double do_operations() {
    const hn::ScalableTag<std::uint8_t> tag;
    using V = hn::Vec<decltype(tag)>;
    constexpr int chains = 6;
    constexpr int rounds = 100000;
    V limit = hn::Set(tag, std::uint8_t{7});
    DISPARITYD_OPAQUE(limit);
    V least0 = limit, least1 = limit, least2 = limit, least3 = limit, least4 = limit, least5 = limit;
    V sum0 = limit, sum1 = limit, sum2 = limit, sum3 = limit, sum4 = limit, sum5 = limit;
    for (int round = 0; round < rounds; ++round) {
        DISPARITYD_ADVANCE(least0, sum0);
        DISPARITYD_ADVANCE(least1, sum1);
        DISPARITYD_ADVANCE(least2, sum2);
        DISPARITYD_ADVANCE(least3, sum3);
        DISPARITYD_ADVANCE(least4, sum4);
        DISPARITYD_ADVANCE(least5, sum5);
    }
    return 2.0 * chains * rounds * static_cast<double>(hn::Lanes(tag));
}

}  // namespace disparityd::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::bench {

double do_byte_operations(std::int64_t target) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, do_operations);
    return built != nullptr ? built() : 0;
}

}  // namespace disparityd::bench
#endif
