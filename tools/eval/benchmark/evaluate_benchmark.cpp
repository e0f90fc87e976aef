// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/evaluate_benchmark.h"

#include <algorithm>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "pipeline/worker_pool.h"
#include "tools/eval/benchmark/benchmark.h"
#include "tools/eval/eval_choices.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/noise.h"
#include "tools/eval/opencv_matcher.h"

namespace disparityd::eval {
namespace {

/// The matchers that run here. One thread uses it.
class MatchersHere {
public:
    MatchersHere(const EvalArguments& arguments, std::vector<Method> methods)
        : arguments_(arguments),
          methods_(std::move(methods)),
          backends_(backends_of(arguments)),
          workers_(arguments.workers.value_or(0)) {
        arguments.match.check_used(methods_);
    }

    std::vector<NamedMap> match(Scene& scene, int disparities) {
        if (arguments_.noise) {
            add_noise(scene, *arguments_.noise, arguments_.shared_noise ? NoiseKind::shared : NoiseKind::independent);
        }
        const int needed = disparities == 0 ? scene.disparities : disparities;
        std::vector<NamedMap> made;
        for (const Method method : methods_) {
            const MatchOptions options = options_for(arguments_, method, needed);
            for (const Backend* backend : backends_) {
                const pipeline::WorkerPool::ComputeSlot slot(workers_);
                made.push_back({std::string(to_string(method)) + " " + std::string(backend->name),
                                judged(run_ours(*backend, options, scene.left, scene.right, workers_, 1))});
            }
        }
        if (arguments_.opencv) {
            const DisparityRange range{arguments_.match.d_min(), arguments_.match.disparities().value_or(needed)};
            for (const OpencvMethod method : opencv_methods()) {
                made.push_back({name(method) + " opencv",
                                judged(run_opencv(method, range, scene.left, scene.right, workers_.workers(), 1))});
            }
        }
        return made;
    }

private:
    static JudgedMap judged(const MatcherResult& result) {
        return {images::to_float(result.map()), {result.confidence.begin(), result.confidence.end()}};
    }

    const EvalArguments& arguments_;
    std::vector<Method> methods_;
    std::vector<const Backend*> backends_;
    pipeline::WorkerPool workers_;
};

Holes holes_of(const std::string& word) {
    for (const Holes holes : {Holes::left_out, Holes::filled}) {
        if (word == name(holes)) {
            return holes;
        }
    }
    return Holes::bad;
}

std::vector<Region> named_regions(const std::vector<std::string>& words) {
    std::vector<Region> regions;
    for (const std::string& word : words) {
        const auto* found =
            std::find_if(all_regions.begin(), all_regions.end(), [&](Region region) { return name(region) == word; });
        if (found == all_regions.end()) {
            std::string allowed;
            for (const Region region : all_regions) {
                allowed += (allowed.empty() ? "" : ", ") + std::string(name(region));
            }
            throw std::invalid_argument("--region: found '" + word + "', allowed: " + allowed);
        }
        regions.push_back(*found);
    }
    return regions;
}

BenchmarkFormat format_of(const EvalArguments& arguments) {
    return arguments.csv        ? BenchmarkFormat::csv
           : arguments.json     ? BenchmarkFormat::json
           : arguments.markdown ? BenchmarkFormat::markdown
                                : BenchmarkFormat::text;
}

void check_matched(const EvalArguments& arguments, bool matched) {
    if (!matched && (arguments.match.any() || arguments.noise || !arguments.backends.empty())) {
        throw std::invalid_argument(
            "--results: found options of matching, but nothing is matched here; add --method or --opencv, or leave "
            "them out");
    }
}

}  // namespace

void evaluate_benchmark(EvalArguments arguments) {
    const bool ours = arguments.results.empty() || !arguments.methods.empty();
    check_matched(arguments, ours || arguments.opencv);
    if (arguments.methods.empty()) {
        arguments.methods = {"sgm"};
    }
    if (arguments.backends.empty()) {
        arguments.backends = {"auto"};
    }
    BenchmarkRequest request;
    for (const std::string& text : arguments.results) {
        request.results.push_back(parse_result_files("--results", text));
    }
    for (const std::string& text : arguments.confidences) {
        request.confidences.push_back(parse_result_files("--confidences", text));
    }
    request.holes = holes_of(arguments.holes);
    request.regions = named_regions(arguments.regions);
    request.format = format_of(arguments);
    request.page = arguments.pictures;
    request.incomplete = arguments.incomplete;
    request.scenes = scenes_of(arguments);
    std::optional<MatchersHere> here;
    if (ours || arguments.opencv) {
        here.emplace(arguments, ours ? methods_of(arguments) : std::vector<Method>{});
        request.match = [&here](Scene& scene, int disparities) { return here->match(scene, disparities); };
    }
    run_benchmark(request, std::cout);
}

}  // namespace disparityd::eval
