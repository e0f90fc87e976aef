// SPDX-License-Identifier: Apache-2.0
#include "tests/kernels/check/kernel_bench.h"

#include <chrono>
#include <cstdio>

#include "kernels/cpu/backend.h"
#include "tests/kernels/check/cycle_counter.h"
#include "tests/kernels/check/kernel_case.h"

namespace disparityd::test {
namespace {

constexpr int rounds = 25;
constexpr int bench_width = 640, bench_height = 48;

/// A variant and the least that a run of it took.
struct Timed {
    KernelRun kernel;
    double ns = 1e30;
    double cycles = 1e30;
};

/// All variants take turns, so that whatever else the machine does meets them all alike.
void time(std::vector<Timed>& variants, const CycleCounter& counter) {
    for (int round = 0; round < rounds; ++round) {
        for (Timed& one : variants) {
            if (one.kernel.prepare) {
                one.kernel.prepare();
            }
            const auto start = std::chrono::steady_clock::now();
            const std::uint64_t first = counter.now();
            one.kernel.run();
            const std::uint64_t last = counter.now();
            const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
            one.ns = std::min(one.ns, taken.count());
            one.cycles = std::min(one.cycles, static_cast<double>(last - first));
        }
    }
}

void print_cell(const std::string& text) {
    std::printf(" %20s", text.c_str());
}

std::string times_text(const Timed& one, bool with_cycles) {
    constexpr double pixels = 1.0 * bench_width * bench_height;
    char text[64];
    if (with_cycles) {
        std::snprintf(text, sizeof text, "%.3f (%.2f)", one.ns / pixels, one.cycles / pixels);
    } else {
        std::snprintf(text, sizeof text, "%.3f", one.ns / pixels);
    }
    return text;
}

void bench(const KernelCase& kernel, int disparities, const CycleCounter& counter) {
    KernelInput input;
    input.seed = 1;
    input.width = bench_width;
    input.height = bench_height;
    input.options = default_options(Method::sgm, {0, disparities});
    input.in_parts = false;
    input.hostile = false;
    std::vector<Timed> variants{{kernel.bind(input, 0)}};
    for (const cpu::InstructionSet& set : cpu::instruction_sets()) {
        variants.push_back({kernel.bind(input, set.target)});
    }
    time(variants, counter);
    std::printf("%-28s %3s", kernel.name.c_str(), kernel.per_pixel ? "" : std::to_string(disparities).c_str());
    for (const Timed& variant : variants) {
        print_cell(times_text(variant, !counter.unit().empty()));
    }
    std::printf("\n");
    std::fflush(stdout);
}

}  // namespace

int bench_kernels(const std::string& filter) {
    const CycleCounter counter;
    std::printf("nanoseconds%s per pixel of %dx%d, least of %d runs in alternation, one thread\n",
                counter.unit().empty() ? "" : (" (" + counter.unit() + ")").c_str(), bench_width, bench_height, rounds);
    std::printf("%-28s %3s", "kernel", "D");
    print_cell("reference");
    for (const cpu::InstructionSet& set : cpu::instruction_sets()) {
        print_cell(set.name);
    }
    std::printf("\n");
    int found = 0;
    for (const KernelCase& kernel : kernel_cases()) {
        if (kernel.name.find(filter) != std::string::npos) {
            ++found;
            if (kernel.per_pixel) {
                bench(kernel, 64, counter);
                continue;
            }
            for (const int disparities : {32, 64, 128}) {
                bench(kernel, disparities, counter);
            }
        }
    }
    return found;
}

}  // namespace disparityd::test
