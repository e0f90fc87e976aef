// SPDX-License-Identifier: Apache-2.0
// The kernels that differ between the variants of paths (see path_variant.h): aggregation and winners.
#if defined(DISPARITYD_CPU_SGM_VARIANT_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_VARIANT_KERNELS_INL_H_
#undef DISPARITYD_CPU_SGM_VARIANT_KERNELS_INL_H_
#else
#define DISPARITYD_CPU_SGM_VARIANT_KERNELS_INL_H_
#endif

#include "kernels/cpu/sgm/aggregation-inl.h"
#include "kernels/cpu/sgm/sgm_winners-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// Returns `kernels`, those of 8 paths in bytes, with the aggregation and the winners of this variant.
template <PathVariant variant>
SgmKernels for_variant(int disparities, SgmKernels kernels) {
    return with_layout(disparities, [&](auto tag, auto registers) {
        kernels.sum_bytes = variant.sum_bytes();
        kernels.adds_sums = variant.may_add();
        kernels.cost_bias = variant.any_p2 ? 0 : cost_bias;
        kernels.rows_at_once = Aggregation<decltype(tag), registers(), variant>::rows_at_once;
        kernels.aggregate = Aggregation<decltype(tag), registers(), variant>::aggregate;
        kernels.winner = SgmWinners<decltype(tag), registers(), variant>::winner;
        return kernels;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
