// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kernels/image.h"
#include "kernels/parallel.h"

namespace disparityd {

/// Spreads the rows of an image over workers: a few blocks for each, so that one who started late does not keep the
/// others waiting.
inline void over_rows(int height, Parallel& workers, FunctionRef<void(Rows)> task) {
    const int blocks = std::min(height, 4 * workers.workers());
    workers.for_each(blocks, [&](int block) { task({height * block / blocks, height * (block + 1) / blocks}); });
}

}  // namespace disparityd
