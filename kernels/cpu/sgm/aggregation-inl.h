// SPDX-License-Identifier: Apache-2.0
// SgmKernels::aggregate for one layout of candidates and one variant of paths.
#if defined(DISPARITYD_CPU_SGM_AGGREGATION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DISPARITYD_CPU_SGM_AGGREGATION_INL_H_
#undef DISPARITYD_CPU_SGM_AGGREGATION_INL_H_
#else
#define DISPARITYD_CPU_SGM_AGGREGATION_INL_H_
#endif

#include "kernels/cpu/sgm/path_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

template <class Tag, int registers, PathVariant variant>
struct Aggregation {
    // Two rows side by side where a row alone leaves the processor idle, as the path along it is a chain of dependent
    // steps: measured 31 to 20 cycles per pixel with one register of 64 lanes, but 50 to 57 with two. With 4 paths
    // there is less beside the chain: 8.6 to 5.4 ns per pixel with two registers of 64 lanes, 10.8 to 7.2 with four
    // of 32.
    static constexpr int rows_at_once = registers == 1 || (!variant.diagonals && registers <= 4) ? 2 : 1;

    // Elsewhere Highway has plain stores in their place.
    static constexpr bool streams = HWY_ARCH_X86;

    template <int count, bool streaming, PathVariant of = variant>
    static void steps_of_rows(const MatchGeometry& geometry, const SweepPass& pass, const PathRow& previous_row,
                              const SweepRow* rows, SweepSteps steps, std::uint8_t* state) {
        PathRows<Tag, registers, count, streaming, of>(geometry, pass, previous_row)
            .run(rows, pass.direction < 0, steps, state);
    }

    static void aggregate(const MatchGeometry& geometry, const SweepPass& pass, const PathRow& previous_row,
                          const SweepRow* rows, int count, SweepSteps steps, std::uint8_t* state) {
        if constexpr (variant.may_add()) {
            if (rows[0].others != nullptr) {
                const auto steps_of = count == rows_at_once ? steps_of_rows<rows_at_once, false, variant.adding()>
                                                            : steps_of_rows<1, false, variant.adding()>;
                steps_of(geometry, pass, previous_row, rows, steps, state);
                return;
            }
        }
        if (count == rows_at_once) {
            if constexpr (streams) {
                if (pass.store == Store::stream) {
                    steps_of_rows<rows_at_once, true>(geometry, pass, previous_row, rows, steps, state);
                    return;
                }
            }
            steps_of_rows<rows_at_once, false>(geometry, pass, previous_row, rows, steps, state);
        } else {
            // A row left over: how it is stored does not matter.
            steps_of_rows<1, false>(geometry, pass, previous_row, rows, steps, state);
        }
    }
};

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
