// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/ideas.h"

#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include <sys/prctl.h>

#include "kernels/cpu/sgm/sgm_matcher.h"
#include "kernels/cpu/step_kernels.h"
#include "tools/bench/vector_paths.h"
#include "tools/bench/work_volumes.h"
#include "tools/command_line/interrupt.h"

namespace disparityd::bench {
namespace {

/// Where code without an idea takes minutes for a frame, both sides get these rows of it.
constexpr int rows_of_slow_code = 32;

/// Somebody who calls a function.
class FunctionContestant final : public Contestant {
public:
    explicit FunctionContestant(std::function<void()> work) : work_(std::move(work)) {}
    void run() override { work_(); }

private:
    std::function<void()> work_;
};

class Ideas {
public:
    Ideas(const StereoPair& pair, const Patience& patience, int threads, WorkerPools& pools)
        : pair_(pair), patience_(patience), threads_(threads), pools_(pools), sets_(cpu::instruction_sets()) {}

    std::vector<Idea> measure() {
        two_passes();
        two_sweeps();
        min_once();
        compiler_vectors();
        if (!sets_.empty()) {
            min_by_tree();
            wide_vectors();
            many_threads();
            beyond_the_paper();
        }
        return std::move(ideas_);
    }

private:
    using Work = std::function<void()>;

    void two_passes() {
        WorkVolumes work(pair_, rows_of_slow_code);
        const MatchingSteps& one_pass = one_pass_steps().matching;
        const MatchingSteps& two_passes = naive_steps(Build::not_vectorised).matching;
        const std::string where = ", scalar code, top " + std::to_string(work.rows().last) + " rows";
        compare_work(
            "two passes, SAD", "window summed anew per candidate; differences once, then box sums" + where,
            [&] { one_pass.sad(work.left(), work.right(), work.range(), work.wide(), work.rows()); },
            [&] { two_passes.sad(work.left(), work.right(), work.range(), work.wide(), work.rows()); });
        compare_work(
            "two passes, CENSUS", "census words made anew per candidate; words first, then differing bits" + where,
            [&] { work.make_costs(one_pass); }, [&] { work.make_costs(two_passes); });
    }

    void two_sweeps() {
        const WorkVolumes work(pair_, pair_.left.rows);
        for (const Build build : {Build::not_vectorised, Build::as_compiled}) {
            compare_work("two sweeps, SGM",
                         std::string("8 paths one after the other over the volume; four paths at a time, ") +
                             (build == Build::not_vectorised ? "scalar code" : "vectorised by the compiler"),
                         paths_one_by_one(work, build), two_sweeps(work, build, plain_variants(build).min_once));
        }
    }

    void min_once() {
        const WorkVolumes work(pair_, rows_of_slow_code);
        const PlainVariants& plain = plain_variants(Build::not_vectorised);
        compare_work(
            "minimum of the pixel before, once",
            "looked for per candidate; once per pixel, scalar code, top " + std::to_string(work.rows().last) + " rows",
            two_sweeps(work, Build::not_vectorised, plain.min_per_candidate),
            two_sweeps(work, Build::not_vectorised, plain.min_once));
    }

    void min_by_tree() {
        const WorkVolumes work(pair_, pair_.left.rows);
        const VectorPaths paths = vector_paths(sets_.front().target);
        compare_work(
            "minimum in log2 steps (the paper's XOR)",
            "lane by lane; halves of the vector, simple " + sets_.front().name + " code for one path at a time",
            two_sweeps(work, Build::as_compiled, paths.lane_by_lane), two_sweeps(work, Build::as_compiled, paths.tree));
    }

    void compiler_vectors() {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            compare_matchers(
                "vector instructions by the compiler, " + std::string(to_string(method)), "the reference, 1 thread",
                [&] { return make_naive(pair_, options(method), Build::not_vectorised, pools_); },
                [&] { return make_naive(pair_, options(method), Build::as_compiled, pools_); });
        }
    }

    void wide_vectors() {
        const cpu::InstructionSet& narrow = sets_.back();
        const cpu::InstructionSet& wide = sets_.front();
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            const std::string which(to_string(method));
            compare_matchers(
                "vector instructions by hand, " + which,
                "the reference vectorised by the compiler; ours with " + wide.name + ", 1 thread",
                [&] { return make_naive(pair_, options(method), Build::as_compiled, pools_); },
                [&] { return make_ours(pair_, options(method), wide, {1}, pools_); });
            if (narrow.name != wide.name) {
                compare_matchers(
                    "wide registers, " + which, "ours with " + narrow.name + "; with " + wide.name + ", 1 thread",
                    [&] { return make_ours(pair_, options(method), narrow, {1}, pools_); },
                    [&] { return make_ours(pair_, options(method), wide, {1}, pools_); });
            }
        }
    }

    void many_threads() {
        for (const Method method : {Method::sad, Method::census, Method::sgm}) {
            compare_matchers(
                "threads, " + std::string(to_string(method)), "ours with 1; with " + std::to_string(threads_),
                [&] { return make_ours(pair_, options(method), sets_.front(), {1}, pools_); },
                [&] { return make_ours(pair_, options(method), sets_.front(), {threads_}, pools_); });
        }
    }

    void beyond_the_paper() {
        constexpr std::size_t no_cache = 0, endless_cache = std::numeric_limits<std::size_t>::max();
        compare_matchers(
            "stores past the caches, sgm", "volumes written through the caches; past them, ours, 1 thread",
            [&] { return sgm_with_cache(endless_cache); }, [&] { return sgm_with_cache(no_cache); });
        compare_matchers(
            "large pages, sgm", "pages of the usual size; large ones where the system gives them, ours, 1 thread",
            [&] {
                prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
                Contestants made = make_ours(pair_, options(Method::sgm), sets_.front(), {1}, pools_);
                prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
                return made;
            },
            [&] { return make_ours(pair_, options(Method::sgm), sets_.front(), {1}, pools_); });
    }

    Contestants sgm_with_cache(std::size_t cache_bytes) {
        const MatcherConfig config{pair_.left.cols, pair_.left.rows, options(Method::sgm)};
        const std::int64_t target = sets_.front().target;
        const auto create = [&] {
            return std::make_unique<cpu::SgmMatcher>(config, cpu::frame_steps(target), target, cache_bytes);
        };
        return make_with(create, pair_, "cpu/sgm", sets_.front().name, pools_);
    }

    MatchOptions options(Method method) const { return default_options(method, {0, pair_.disparities}); }

    static Work paths_one_by_one(const WorkVolumes& work, Build build) {
        const MatchingSteps& steps = naive_steps(build).matching;
        const auto scratch = std::make_shared<std::vector<std::byte>>(
            steps.aggregate_scratch(work.left().width, work.left().height, work.range().count));
        return [&work, &steps, scratch] {
            Serial serial;
            SgmOptions options = default_options(Method::sgm).sgm;
            options.adaptive_p2 = false;
            steps.aggregate(work.costs(), work.left(), options, work.wide(), *scratch, serial);
        };
    }

    static Work two_sweeps(const WorkVolumes& work, Build build, ContinuePath continue_path) {
        const PlainVariants& plain = plain_variants(build);
        const auto scratch = std::make_shared<std::vector<std::uint8_t>>(
            plain.two_sweeps_scratch(work.left().width, work.range().count));
        return [&work, &plain, scratch, continue_path] {
            const SgmOptions options = default_options(Method::sgm).sgm;
            plain.aggregate_in_two_sweeps(work.costs(), options.p1, options.p2, work.wide(), *scratch, continue_path);
        };
    }

    void compare_work(const std::string& idea, const std::string& compared, const Work& without, const Work& with) {
        Contestants both;
        both.push_back(std::make_unique<FunctionContestant>(without));
        both.push_back(std::make_unique<FunctionContestant>(with));
        compare(idea, compared, std::move(both));
    }

    void compare_matchers(const std::string& idea, const std::string& compared,
                          const std::function<Contestants()>& without, const std::function<Contestants()>& with) {
        if (tools::interrupted()) {
            return;
        }
        Contestants both = without();
        for (auto& contestant : with()) {
            both.push_back(std::move(contestant));
        }
        compare(idea, compared, std::move(both));
    }

    void compare(const std::string& idea, const std::string& compared, Contestants both) {
        const std::vector<Measurement> found = alternate(pair_, both, patience_);
        if (found.size() == 2) {
            ideas_.push_back({idea, compared, found[0].median_ms(), found[1].median_ms()});
        }
    }

    const StereoPair& pair_;
    const Patience& patience_;
    int threads_;
    WorkerPools& pools_;
    std::vector<cpu::InstructionSet> sets_;
    std::vector<Idea> ideas_;
};

}  // namespace

std::vector<Idea> measure_ideas(const StereoPair& pair, const Patience& patience, int threads, WorkerPools& pools) {
    return Ideas(pair, patience, threads, pools).measure();
}

tools::Table idea_table(const std::vector<Idea>& ideas) {
    tools::Table table({"idea", "without; with", "ms without", "ms with", "gain"});
    for (const Idea& one : ideas) {
        const double gain = one.without_ms / one.with_ms;
        table.add({one.idea, one.compared, tools::fixed(one.without_ms, 2), tools::fixed(one.with_ms, 2),
                   tools::fixed(gain, gain < 10 ? 2 : 0) + "x"});
    }
    return table;
}

}  // namespace disparityd::bench
