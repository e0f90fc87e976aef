// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/backend.h"

#include <algorithm>
#include <thread>

#include "hwy/targets.h"
#include "kernels/cpu/block_matcher.h"
#include "kernels/cpu/cache_size.h"
#include "kernels/cpu/sgm/sgm_matcher.h"
#include "kernels/cpu/step_kernels.h"
#include "kernels/frame_stages.h"
#include "kernels/near_guard.h"

namespace disparityd::cpu {

std::vector<InstructionSet> instruction_sets() {
    std::vector<InstructionSet> found;
    for (const std::int64_t target : {HWY_AVX3_DL, HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_NEON}) {
        constexpr int any_disparities = 64;
        if ((hwy::SupportedTargets() & target) != 0 && sgm_kernels(target, any_disparities).layout.lanes != 0) {
            found.push_back({hwy::TargetName(target), target});
        }
    }
    return found;
}

namespace {

std::unique_ptr<Matcher> create_unguarded(const MatcherConfig& config, std::int64_t target) {
    if (config.options.method != Method::sgm) {
        const int cores = static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
        return std::make_unique<BlockMatcher>(config, frame_steps(target), target, cores);
    }
    return std::make_unique<SgmMatcher>(config, frame_steps(target), target, last_level_cache_bytes());
}

}  // namespace

std::unique_ptr<Matcher> create(const MatcherConfig& config, const InstructionSet& instruction_set) {
    const std::int64_t target = instruction_set.target;
    return with_near_guard(checked(config), frame_steps(target),
                           [target](const MatcherConfig& made) { return create_unguarded(made, target); });
}

bool available() {
    return !instruction_sets().empty();
}

std::unique_ptr<Matcher> create_best(const MatcherConfig& config) {
    return create(config, instruction_sets().front());
}

}  // namespace disparityd::cpu
