// SPDX-License-Identifier: Apache-2.0
//
// The kernel alone: the library of all kernels takes ten minutes to build with sanitizers.
#include "tests/fuzz/scan_vectors.h"

#define HWY_TARGET_INCLUDE "tests/fuzz/scan_vectors.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"
#include "kernels/cpu/simd/instruction_sets.h"

#if DISPARITYD_CPU_VECTORS
#include "kernels/cpu/scan/scan_counts-inl.h"

HWY_BEFORE_NAMESPACE();
namespace disparityd::cpu::HWY_NAMESPACE {

scan::CountPixels* fuzzed_scan_counts() {
    return scan_counts;
}

}  // namespace disparityd::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace disparityd::cpu {

scan::CountPixels* counts_of(std::int64_t target) {
    const auto built = DISPARITYD_FUNCTION_FOR(target, fuzzed_scan_counts);
    return built != nullptr ? built() : nullptr;
}

}  // namespace disparityd::cpu

namespace disparityd::fuzz {

std::vector<scan::CountPixels*> vectorised_scan_counts() {
    std::vector<scan::CountPixels*> found;
    for (std::int64_t targets = hwy::SupportedTargets(); targets != 0; targets &= targets - 1) {
        if (auto* const counts = cpu::counts_of(targets & -targets)) {
            found.push_back(counts);
        }
    }
    return found;
}

}  // namespace disparityd::fuzz
#endif
