// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::bench {

/// Keeps one thread busy with minima and sums in registers that do not depend on each other, for a fraction of a
/// millisecond. Returns how many operations on single bytes that was; 0 where the kernels are not built for the
/// instruction set.
double do_byte_operations(std::int64_t target);

}  // namespace disparityd::bench
