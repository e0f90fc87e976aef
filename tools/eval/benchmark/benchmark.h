// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/eval/benchmark/benchmark_report.h"
#include "tools/eval/benchmark/result_files.h"
#include "tools/eval/scene.h"

namespace disparityd::eval {

/// A disparity map of the scene at hand, and who made it.
struct NamedMap {
    std::string matcher;
    JudgedMap map;
};

/// What is to be judged, and how.
struct BenchmarkRequest {
    std::vector<SceneToJudge> scenes;
    std::vector<ResultFiles> results;      ///< of other programs
    std::vector<ResultFiles> confidences;  ///< of these, by the matcher's name
    /// Gives the maps of matchers that run here; `disparities` as SceneToJudge has it. May be empty.
    std::function<std::vector<NamedMap>(Scene& scene, int disparities)> match;
    Holes holes = Holes::bad;
    std::vector<Region> regions;  ///< that are told; empty = all that are known
    BenchmarkFormat format = BenchmarkFormat::text;
    std::string page;         ///< folder, exists; empty = no page
    bool incomplete = false;  ///< scenes that cannot be judged are left out, and told
};

/// Judges each matcher on each scene as the benchmarks do, prints the figures and writes the page. A note on stderr
/// tells of each scene whose result is missing, of another size, or unreadable. Throws std::invalid_argument after
/// these unless the request allows it to be incomplete, before anything is matched where files are missing, and where
/// two scenes have one name.
void run_benchmark(const BenchmarkRequest& request, std::ostream& to);

}  // namespace disparityd::eval
