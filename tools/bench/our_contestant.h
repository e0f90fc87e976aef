// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "kernels/cpu/backend.h"
#include "kernels/options.h"
#include "tools/bench/contestant.h"
#include "tools/bench/naive.h"
#include "tools/bench/stereo_pair.h"
#include "tools/bench/worker_pools.h"

namespace disparityd::bench {

using Contestants = std::vector<std::unique_ptr<Contestant>>;

/// The vectorised back end with one instruction set: a contestant for each number of threads, all with the same
/// matcher. Matches the first frame. `pools` outlives them. Throws as Backend::create does.
Contestants make_ours(const StereoPair& pair, const MatchOptions& options, const cpu::InstructionSet& instruction_set,
                      const std::vector<int>& threads, WorkerPools& pools);

/// The reference, on one thread. The rest as make_ours().
Contestants make_naive(const StereoPair& pair, const MatchOptions& options, Build build, WorkerPools& pools);

/// Any matcher, on one thread. The rest as make_ours().
Contestants make_with(const std::function<std::unique_ptr<Matcher>()>& create, const StereoPair& pair,
                      const std::string& name, const std::string& isa, WorkerPools& pools);

}  // namespace disparityd::bench
