// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sgm_winners.h"

#define HWY_TARGET_INCLUDE "kernels/cpu/sgm/sgm_winners.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/sgm/sgm_winners-inl.h"
#include "kernels/cpu/simd/layouts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

inline SgmWinner winner_of(int disparities) {
    return with_layout(disparities, [](auto tag, auto registers) -> SgmWinner {
        return SgmWinners<decltype(tag), registers(), eight_paths_u8_sums>::winner;
    });
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

SgmWinner sgm_winner(std::int64_t target, int disparities) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, winner_of);
    return built != nullptr ? built(disparities) : nullptr;
}

}  // namespace disparityd::cpu
#endif
