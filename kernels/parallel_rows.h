// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kernels/image.h"
#include "kernels/parallel.h"

namespace disparityd {

/// Runs `task` on blocks of rows of an image, spread over the workers. Each worker has a few blocks, so that one that
/// starts late does not keep the others waiting.
inline void parallel_rows(int height, Parallel& workers, FunctionRef<void(Rows)> task) {
    const int blocks = std::min(height, 4 * workers.workers());
    workers.for_each(blocks, [&](int block) { task({height * block / blocks, height * (block + 1) / blocks}); });
}

}  // namespace disparityd
