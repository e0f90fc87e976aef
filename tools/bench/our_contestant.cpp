// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/our_contestant.h"

#include <limits>
#include <utility>

#include "kernels/step_matcher.h"
#include "tools/bench/allocation_meter.h"
#include "tools/eval/frame_buffers.h"

namespace disparityd::bench {
namespace {

double megabytes(std::optional<std::int64_t> bytes) {
    return bytes ? static_cast<double>(*bytes) / 1e6 : std::numeric_limits<double>::quiet_NaN();
}

/// A matcher and what it works on, shared by contestants that differ in their number of threads only.
struct MatchedPair {
    MatchedPair(std::unique_ptr<Matcher> made, const StereoPair& pair)
        : matcher(std::move(made)), frame(*matcher, pair.left, pair.right, serial) {}

    Serial serial;
    std::unique_ptr<Matcher> matcher;
    eval::FrameBuffers frame;
};

class OurContestant final : public Contestant {
public:
    OurContestant(std::shared_ptr<MatchedPair> pair, pipeline::WorkerPool& pool)
        : pair_(std::move(pair)), pool_(pool) {}

    void prepare() override { slot_.emplace(pool_); }
    void run() override { pair_->frame.match(pool_); }
    void finish() override { slot_.reset(); }

    std::vector<StepTime> steps() const override {
        std::vector<StepTime> steps;
        const auto& times = pair_->frame.step_times();
        for (const StageInfo& stage : pair_->matcher->stages().subspan(1)) {
            for (const std::string_view step : stage.steps) {
                const std::chrono::duration<double, std::milli> time = times[steps.size()];
                steps.push_back({std::string(step), time.count()});
            }
        }
        return steps;
    }

private:
    std::shared_ptr<MatchedPair> pair_;
    pipeline::WorkerPool& pool_;
    std::optional<pipeline::WorkerPool::ComputeSlot> slot_;
};

struct Who {
    std::string name;
    std::string isa;
    std::vector<int> threads;
};

Contestants make(const StereoPair& pair, const std::function<std::unique_ptr<Matcher>()>& create, const Who& who,
                 WorkerPools& pools) {
    for (const int threads : who.threads) {
        pools.with(threads);  // before the meter: their memory is not the matcher's
    }
    const AllocationMeter meter;
    const auto matched = std::make_shared<MatchedPair>(create(), pair);
    {
        const pipeline::WorkerPool::ComputeSlot slot(pools.with(who.threads.front()));
        matched->frame.match(pools.with(who.threads.front()));
    }
    const double memory = megabytes(meter.peak_bytes());
    Contestants all;
    for (const int threads : who.threads) {
        auto one = std::make_unique<OurContestant>(matched, pools.with(threads));
        one->name = who.name;
        one->isa = who.isa;
        one->threads = threads;
        one->memory_mb = memory;
        all.push_back(std::move(one));
    }
    return all;
}

}  // namespace

Contestants make_ours(const StereoPair& pair, const MatchOptions& options, const cpu::InstructionSet& instruction_set,
                      const std::vector<int>& threads, WorkerPools& pools) {
    const MatcherConfig config{pair.left.cols, pair.left.rows, options};
    return make(
        pair, [&] { return cpu::create(config, instruction_set); },
        {"cpu/" + std::string(to_string(options.method)), instruction_set.name, threads}, pools);
}

Contestants make_naive(const StereoPair& pair, const MatchOptions& options, Build build, WorkerPools& pools) {
    const MatcherConfig config{pair.left.cols, pair.left.rows, options};
    return make(
        pair, [&] { return std::make_unique<StepMatcher>(config, naive_steps(build)); },
        {"naive/" + std::string(to_string(options.method)), build == Build::as_compiled ? "compiled" : "scalar", {1}},
        pools);
}

Contestants make_with(const std::function<std::unique_ptr<Matcher>()>& create, const StereoPair& pair,
                      const std::string& name, const std::string& isa, WorkerPools& pools) {
    return make(pair, create, {name, isa, {1}}, pools);
}

}  // namespace disparityd::bench
