// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/naive.h"

#include "kernels/reference/steps.h"

// Made by renamed_reference.h.
namespace disparityd::reference_not_vectorised {
extern const KernelSteps steps;
}

namespace disparityd::bench {

namespace as_compiled {
extern const PlainVariants variants;
}
namespace not_vectorised {
extern const PlainVariants variants;
}

const KernelSteps& naive_steps(Build build) {
    return build == Build::as_compiled ? reference::steps : reference_not_vectorised::steps;
}

const KernelSteps& one_pass_steps() {
    static const KernelSteps one_pass = [] {
        KernelSteps steps = naive_steps(Build::not_vectorised);
        const PlainVariants& plain = plain_variants(Build::not_vectorised);
        steps.matching.sad = plain.sad_in_one_pass;
        steps.matching.census_costs[0] = {plain.pixels_as_words, plain.matching_cost_in_one_pass};
        return steps;
    }();
    return one_pass;
}

const PlainVariants& plain_variants(Build build) {
    return build == Build::as_compiled ? as_compiled::variants : not_vectorised::variants;
}

}  // namespace disparityd::bench
