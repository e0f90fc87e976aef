// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/cost/census_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/cost/census_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/cost/matching_cost-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

inline void put_census_9x7(int disparities, SgmKernels& kernels) {
    with_layout(disparities, [&](auto tag, auto registers) {
        kernels.census_layout = census_layout<Census9x7>;
        using Unit = CensusUnit<Census9x7, registers()>;
        kernels.census = {census_left<Census9x7, Unit>, census_right<Census9x7, registers()>};
        kernels.matching_cost = matching_cost<decltype(tag), registers(), Census9x7>;
        return 0;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

void use_census_9x7(std::int64_t target, int disparities, SgmKernels& kernels) {
    const auto put = DISPARITYD_FUNCTION_FOR(target, put_census_9x7);
    if (put != nullptr) {
        put(disparities, kernels);
    }
}

}  // namespace disparityd::cpu
#endif
