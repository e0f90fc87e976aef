// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/alternation.h"

#include <algorithm>
#include <chrono>
#include <ctime>

#include "tools/command_line/interrupt.h"
#include "tools/command_line/progress.h"
#include "tools/eval/means.h"

namespace disparityd::bench {
namespace {

using std::chrono::steady_clock;

double half_median(std::vector<double> ms, bool upper) {
    std::sort(ms.begin(), ms.end());
    const std::size_t half = (ms.size() + 1) / 2;
    return eval::median(upper ? std::vector<double>(ms.end() - static_cast<std::ptrdiff_t>(half), ms.end())
                              : std::vector<double>(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(half)));
}

/// Of the whole program.
double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) / 1e6;
}

Measurement begin(const StereoPair& pair, const Contestant& contestant) {
    Measurement measurement;
    measurement.scene = pair.scene;
    measurement.width = pair.left.cols;
    measurement.height = pair.left.rows;
    measurement.disparities = pair.disparities;
    measurement.name = contestant.name;
    measurement.isa = contestant.isa;
    measurement.threads = contestant.threads;
    measurement.memory_mb = contestant.memory_mb;
    return measurement;
}

void run_once(Contestant& contestant, Measurement& measurement, double long_frame_ms) {
    contestant.prepare();
    if (measurement.ms.empty() || measurement.ms.back() < long_frame_ms) {
        contestant.run();
    }
    const double processor_start = processor_ms();
    const auto start = steady_clock::now();
    contestant.run();
    const std::chrono::duration<double, std::milli> taken = steady_clock::now() - start;
    measurement.ms.push_back(taken.count());
    measurement.cpu_ms.push_back(processor_ms() - processor_start);
    contestant.finish();
    for (const StepTime& time : contestant.steps()) {
        std::vector<double>& times = measurement.step_ms[time.step];
        if (times.empty()) {
            measurement.steps.push_back(time.step);
        }
        times.push_back(time.ms);
    }
}

/// How many of the rounds a contestant takes part in.
int rounds_for(const Measurement& measurement, const Patience& patience) {
    const double affordable = patience.seconds * 1e3 / std::max(measurement.ms.front(), 1e-3);
    const int most = std::max(patience.rounds, 1);
    return static_cast<int>(
        std::clamp(affordable, static_cast<double>(std::min(patience.min_rounds, most)), static_cast<double>(most)));
}

/// Whether a contestant with `turns` of `rounds` rounds takes part in this one: `turns` times, evenly spread, in the
/// first one always.
bool takes_part(std::int64_t round, std::int64_t turns, std::int64_t rounds) {
    return round == 0 || round * turns / rounds != (round - 1) * turns / rounds;
}

}  // namespace

double Measurement::median_ms() const {
    return eval::median(ms);
}

double Measurement::median_cpu_ms() const {
    return eval::median(cpu_ms);
}

double Measurement::min_ms() const {
    return *std::min_element(ms.begin(), ms.end());
}

double Measurement::lower_quartile_ms() const {
    return half_median(ms, false);
}

double Measurement::upper_quartile_ms() const {
    return half_median(ms, true);
}

double Measurement::gde_per_second() const {
    return static_cast<double>(width) * height * disparities / (median_ms() * 1e6);
}

std::vector<Measurement> alternate(const StereoPair& pair, const Contestants& contestants, const Patience& patience) {
    std::vector<Measurement> measurements;
    for (const auto& contestant : contestants) {
        measurements.push_back(begin(pair, *contestant));
    }
    tools::Progress progress("rounds", static_cast<std::uint64_t>(patience.rounds));
    for (int round = 0; round < patience.rounds; ++round) {
        for (std::size_t i = 0; i < contestants.size() && !tools::interrupted(); ++i) {
            if (round == 0 || takes_part(round, rounds_for(measurements[i], patience), patience.rounds)) {
                progress.show(static_cast<std::uint64_t>(round), pair.scene + ' ' + contestants[i]->name);
                run_once(*contestants[i], measurements[i], patience.long_frame_ms);
            }
        }
    }
    std::erase_if(measurements, [](const Measurement& measurement) { return measurement.ms.empty(); });
    return measurements;
}

}  // namespace disparityd::bench
