// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>

#include "pipeline/worker_pool.h"

namespace disparityd::bench {

/// The worker pools of the daemon, one for each number of workers. Used by one thread.
class WorkerPools {
public:
    /// Made at the first call.
    pipeline::WorkerPool& with(int workers) {
        std::unique_ptr<pipeline::WorkerPool>& pool = pools_[workers];
        if (pool == nullptr) {
            pool = std::make_unique<pipeline::WorkerPool>(workers);
        }
        return *pool;
    }

private:
    std::map<int, std::unique_ptr<pipeline::WorkerPool>> pools_;
};

}  // namespace disparityd::bench
