// SPDX-License-Identifier: Apache-2.0
#include "trust/trust_stage.h"

#include <cstring>

namespace disparityd::trust {

void TrustStage::run(const StageFrame& frame, Parallel& /*workers*/) {
    const Verdict verdict = judge_.judge(frame.view, frame.monotonic_ns, frame.discontinuity);
    std::memcpy(frame.memory.data(), &verdict, sizeof verdict);
}

Verdict verdict_of(std::span<const std::byte> memory) {
    Verdict verdict;
    std::memcpy(&verdict, memory.data(), sizeof verdict);
    return verdict;
}

}  // namespace disparityd::trust
