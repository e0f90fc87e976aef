// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/cpu/backend.h"
#include "kernels/options.h"
#include "pipeline/worker_pool.h"
#include "tools/bench/naive.h"
#include "tools/bench/stereo_pair.h"

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

/// How long a step of a frame took.
struct StepTime {
    std::string step;
    double ms = 0;
};

/// Somebody who matches one pair over and over. One thread uses it.
class Contestant {
public:
    std::string name;      ///< "cpu/sgm", "naive/sad", "opencv/3way" ..
    std::string isa;       ///< vector instructions: "AVX2", .., "compiled" (the compiler's choice), "scalar"; or "GPU"
    int threads = 1;       ///< at most
    double memory_mb = 0;  ///< held at once from its making to the end of its first frame; NaN = not known

    Contestant() = default;
    virtual ~Contestant() = default;
    Contestant(const Contestant&) = delete;
    Contestant& operator=(const Contestant&) = delete;

    /// Before the clock starts.
    virtual void prepare() {}
    /// One frame.
    virtual void run() = 0;
    /// After the clock was stopped.
    virtual void finish() {}
    /// Of the last frame; empty where steps cannot be told apart.
    virtual std::vector<StepTime> steps() const { return {}; }
};

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
