// SPDX-License-Identifier: Apache-2.0
// What SgmKernels has in its own way for each form of paths (see path_form.h): aggregation and winners.
#if defined(DISPARITYD_CPU_FORM_KERNELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_FORM_KERNELS_INL_H_
#undef DISPARITYD_CPU_FORM_KERNELS_INL_H_
#else
#define DISPARITYD_CPU_FORM_KERNELS_INL_H_
#endif

#include "kernels/cpu/aggregation-inl.h"
#include "kernels/cpu/layouts-inl.h"
#include "kernels/cpu/sgm_winners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

/// `kernels`, those of 8 paths in bytes, with what this form has in its own way.
template <PathForm form>
SgmKernels in_form(int disparities, SgmKernels kernels) {
    return with_layout(disparities, [&](auto tag, auto registers) {
        kernels.sum_bytes = form.sum_bytes();
        kernels.raised_cost = 0;
        kernels.aggregate = Aggregation<decltype(tag), registers(), form>::aggregate;
        kernels.winner = SgmWinners<decltype(tag), registers(), form>::winner;
        return kernels;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
