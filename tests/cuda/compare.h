// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tests/kernels/any_pair.h"

namespace disparityd::test {

struct MethodAndCost {
    Method method;
    CensusCost cost;
};

/// Each method with each cost that it has.
constexpr std::array<MethodAndCost, 5> methods_and_costs = {{{Method::sad, CensusCost::census_9x7},
                                                             {Method::census, CensusCost::census_9x7},
                                                             {Method::census, CensusCost::census_7x5_gradient},
                                                             {Method::sgm, CensusCost::census_9x7},
                                                             {Method::sgm, CensusCost::census_7x5_gradient}}};

/// The back end cuda.
inline void expect_equal_to_reference(const Pair& pair, const MatchOptions& options) {
    Serial serial;
    const auto matcher = backend("cuda").create({pair.width(), pair.height(), options});
    expect_equal_to_reference(*matcher, pair, serial);
}

}  // namespace disparityd::test
