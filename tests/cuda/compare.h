// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/kernels/any_pair.h"

namespace disparityd::test {

/// The back end cuda.
inline void expect_equal_to_reference(const Pair& pair, const MatchOptions& options) {
    Serial serial;
    const auto matcher = backend("cuda").create({pair.width(), pair.height(), options});
    expect_equal_to_reference(*matcher, pair, serial);
}

}  // namespace disparityd::test
