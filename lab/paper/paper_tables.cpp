// SPDX-License-Identifier: Apache-2.0
#include "lab/paper/paper_tables.h"

#include <algorithm>
#include <array>
#include <ostream>

#include "kernels/options.h"
#include "tools/bench/report.h"
#include "tools/eval/paper.h"

namespace disparityd::lab {
namespace {

using bench::Measurement;
using tools::fixed;

/// Milliseconds of the paper's tables 1 and 2: naive code, and a 20-core Xeon with AVX.
struct PaperTime {
    double naive;
    double fast;
};
struct PaperTimes {
    const char* scene;
    PaperTime sad, census, sgm;
};
constexpr std::array<PaperTimes, 4> paper_times = {{{"cones", {2569, 164}, {2215, 14}, {4286, 81}},
                                                    {"tsukuba", {1733, 171}, {1464, 12}, {2807, 54}},
                                                    {"teddy", {2640, 165}, {2199, 16}, {4252, 82}},
                                                    {"sawtooth", {2530, 159}, {2193, 14}, {4129, 78}}}};

PaperTime time_of(const PaperTimes& times, Method method) {
    switch (method) {
        case Method::sad: return times.sad;
        case Method::census: return times.census;
        case Method::sgm: break;
    }
    return times.sgm;
}

std::string cell(const Measurement* measurement) {
    return measurement == nullptr ? "-" : fixed(measurement->median_ms(), 2);
}

std::string speed_up(const Measurement* slow, const Measurement* fast) {
    return slow == nullptr || fast == nullptr ? "-" : fixed(slow->median_ms() / fast->median_ms(), 0) + "x";
}

/// The best instruction set comes first.
const Measurement* ours(const std::vector<Measurement>& scene, const std::string& name, int threads) {
    return find(scene, name, "", threads);
}

int max_threads(const std::vector<Measurement>& scene) {
    int most = 1;
    for (const Measurement& one : scene) {
        most = std::max(most, one.threads);
    }
    return most;
}

std::vector<std::string> row(const PaperTimes& paper, Method method, const std::vector<Measurement>& scene) {
    const std::string name(disparityd::to_string(method));
    const PaperTime time = time_of(paper, method);
    const int threads = max_threads(scene);
    const Measurement* described = find(scene, "paper/" + name, "scalar", 1);
    const Measurement* scalar = find(scene, "naive/" + name, "scalar", 1);
    const Measurement* compiled = find(scene, "naive/" + name, "compiled", 1);
    const Measurement* one = ours(scene, "cpu/" + name, 1);
    const Measurement* all = ours(scene, "cpu/" + name, threads);
    return {std::string(eval::paper_scene(paper.scene)->name) + " (" + std::to_string(scene.front().disparities) + ")",
            fixed(time.naive, 0),
            fixed(time.fast, 0),
            fixed(time.naive / time.fast, 0) + "x",
            cell(described),
            cell(scalar),
            cell(compiled),
            cell(one),
            cell(all),
            speed_up(described, one) + " / " + speed_up(described, all),
            speed_up(scalar, one) + " / " + speed_up(scalar, all),
            speed_up(compiled, one) + " / " + speed_up(compiled, all)};
}

std::vector<Measurement> of_scene(const std::vector<Measurement>& measurements, const std::string& scene) {
    std::vector<Measurement> some;
    std::copy_if(measurements.begin(), measurements.end(), std::back_inserter(some),
                 [&](const Measurement& measurement) { return measurement.scene == scene; });
    return some;
}

void print_method(const std::vector<Measurement>& measurements, Method method, std::ostream& to) {
    const std::string threads = std::to_string(max_threads(measurements));
    tools::Table table({"scene (D)", "paper naive", "paper 20 cores", "paper gain", "naive as described",
                        "reference, scalar", "reference, compiled", "ours 1 thread", "ours " + threads,
                        "gain on naive as described, 1 / " + threads, "on the reference, scalar",
                        "on the reference, compiled"});
    for (const PaperTimes& paper : paper_times) {
        const std::vector<Measurement> scene = of_scene(measurements, paper.scene);
        if (!scene.empty()) {
            table.add(row(paper, method, scene));
        }
    }
    table.print_markdown(to);
}

}  // namespace

void print_paper_tables(const std::vector<bench::Measurement>& measurements, std::ostream& to) {
    if (std::none_of(paper_times.begin(), paper_times.end(),
                     [&](const PaperTimes& paper) { return !of_scene(measurements, paper.scene).empty(); })) {
        return;
    }
    to << "\nTable 1, SAD (ms):\n\n";
    print_method(measurements, Method::sad, to);
    to << "\nTable 1, CENSUS (ms):\n\n";
    print_method(measurements, Method::census, to);
    to << "\nTable 2, SGM (ms):\n\n";
    print_method(measurements, Method::sgm, to);
}

}  // namespace disparityd::lab
