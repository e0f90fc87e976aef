// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/cost/gradient_kernels.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/cost/gradient_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/cost/matching_cost-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

inline void put_gradient_cost(int disparities, SgmKernels& kernels) {
    with_layout(disparities, [&](auto tag, auto registers) {
        kernels.census_layout = census_layout<Census7x5Gradient>;
        kernels.census = {census_left<Census7x5Gradient, std::uint8_t>, census_right<Census7x5Gradient, registers()>};
        using Fine = NoisyCensus7x5Gradient<1>;
        using Coarse = NoisyCensus7x5Gradient<2>;
        kernels.noisy_census[0] = {census_left<Fine, std::uint8_t>, census_right<Fine, registers()>};
        kernels.noisy_census[1] = {census_left<Coarse, std::uint8_t>, census_right<Coarse, registers()>};
        kernels.matching_cost = matching_cost<decltype(tag), registers(), Census7x5Gradient>;
        kernels.averages_costs = true;
        return 0;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

void use_cost(CensusCost cost, std::int64_t target, int disparities, SgmKernels& kernels) {
    if (cost == CensusCost::census_9x7) {
        return;
    }
    const auto put = DISPARITYD_FUNCTION_FOR(target, put_gradient_cost);
    if (put != nullptr && kernels.layout.lanes != 0) {
        put(disparities, kernels);
    }
}

}  // namespace disparityd::cpu
#endif
