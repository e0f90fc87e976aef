// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sgm_kernels.h"

#include "kernels/cpu/cost/census_kernels.h"
#include "kernels/cpu/sgm/sgm_winners.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/sgm/sgm_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/sgm/adaptive_p2-inl.h"
#include "kernels/cpu/sgm/aggregation-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers>
struct Kernels {
    using Paths = Aggregation<Tag, registers, eight_paths_u8_sums>;
    static constexpr int lanes = static_cast<int>(hn::MaxLanes(Tag()));

    static SgmKernels table() {
        SgmKernels kernels;
        kernels.layout = {lanes, registers};
        kernels.cost_bias = cost_bias;
        kernels.rows_at_once = Paths::rows_at_once;
        kernels.streams = Paths::streams;
        kernels.aggregate = Paths::aggregate;
        kernels.adaptive_p2 = adaptive_p2;
        return kernels;
    }
};

inline SgmKernels kernels_of(int disparities) {
    return with_layout(disparities,
                       [](auto tag, auto registers) { return Kernels<decltype(tag), registers()>::table(); });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

SgmKernels sgm_kernels(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, kernels_of);
    if (built == nullptr) {
        return {};
    }
    SgmKernels kernels = built(disparities);
    use_census_9x7(target, disparities, kernels);
    kernels.winner = sgm_winner(target, disparities);
    return kernels;
}

}  // namespace disparityd::cpu
#endif
