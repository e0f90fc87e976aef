// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace disparityd::test {

/// Prints how long the kernels take whose names contain `filter`: nanoseconds per pixel, and cycles where they can be
/// counted, of the reference and of each instruction set. Returns how many kernels that were.
int bench_kernels(const std::string& filter);

}  // namespace disparityd::test
