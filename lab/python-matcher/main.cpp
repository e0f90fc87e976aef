// SPDX-License-Identifier: Apache-2.0
// Times calls of PairMatcher for lab/measure-python, which alternates between this program and Python.
//   disparity-pair-times FILE WIDTH HEIGHT DISPARITIES PRESET THREADS: FILE has both grey images, the left one first.
// Each line on standard input asks for a call; the answer is its time in ms, the processor time of all
// threads in ms, and a checksum of the disparities.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/match_fields.h"
#include "kernels/pair_matcher.h"
#include "pipeline/worker_pool.h"

namespace {

using namespace disparityd;

Preset preset_of(const std::string& name) {
    for (const Preset preset : all_presets) {
        if (to_string(preset) == name) {
            return preset;
        }
    }
    throw std::invalid_argument("no preset " + name);
}

void answer_calls(char** arguments) {
    const int width = std::atoi(arguments[2]), height = std::atoi(arguments[3]);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    std::vector<std::uint8_t> pair(2 * pixels), confidence(pixels);
    std::vector<std::int16_t> disparity(pixels);
    std::ifstream file(arguments[1], std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(pair.data()), static_cast<std::streamsize>(pair.size()))) {
        throw std::invalid_argument(std::string(arguments[1]) + ": too short");
    }
    PairMatcher matcher(width, height, preset_options(preset_of(arguments[5]), {0, std::atoi(arguments[4])}));
    pipeline::WorkerPool pool(std::atoi(arguments[6]), pipeline::Pinning::never);
    PairResults results;
    results.disparity = {disparity.data(), width, height, width};
    results.confidence = {confidence.data(), width, height, width};
    for (std::string line; std::getline(std::cin, line);) {
        const auto begin = std::chrono::steady_clock::now();
        const std::clock_t computed = std::clock();
        {
            const pipeline::WorkerPool::ComputeSlot slot(pool);
            matcher.match({pair.data(), width, height, width}, {pair.data() + pixels, width, height, width}, results,
                          pool);
        }
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
        const double processor_ms = 1000.0 * static_cast<double>(std::clock() - computed) / CLOCKS_PER_SEC;
        std::cout << took.count() << ' ' << processor_ms << ' '
                  << std::accumulate(disparity.begin(), disparity.end(), 0LL) << std::endl;
    }
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 7) {
        throw std::invalid_argument("usage: disparity-pair-times FILE WIDTH HEIGHT DISPARITIES PRESET THREADS");
    }
    answer_calls(argv);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "disparity-pair-times: error: %s\n", error.what());
    return 1;
}
