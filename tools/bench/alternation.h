// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/bench/our_contestant.h"

namespace disparityd::bench {

/// How often each contestant runs on a pair.
struct Patience {
    int rounds = 15;            ///< at most
    double seconds = 0.8;       ///< who has used up as much time of its own runs less often ..
    int min_rounds = 3;         ///< .. but at least this often
    double long_frame_ms = 50;  ///< after one of these the next is measured without another before it
};

/// Times of one contestant on one pair.
struct Measurement {
    std::string scene;
    int width = 0;
    int height = 0;
    int disparities = 0;
    std::string name;
    std::string isa;
    int threads = 1;
    double memory_mb = 0;        ///< NaN = not known
    std::vector<double> ms;      ///< one per run, not empty
    std::vector<double> cpu_ms;  ///< processor time of all threads in the same runs
    std::map<std::string, std::vector<double>> step_ms;
    std::vector<std::string> steps;  ///< the keys of step_ms in the order of the work

    double median_ms() const;
    double median_cpu_ms() const;
    double min_ms() const;
    /// The medians of the faster and of the slower half.
    double lower_quartile_ms() const;
    double upper_quartile_ms() const;
    double frames_per_second() const { return 1e3 / median_ms(); }
    /// Disparities evaluated per second, in thousand millions, all columns counted.
    double gde_per_second() const;
};

/// Runs all contestants in turn, round after round, so that whatever else the machine does meets them all alike. A
/// frame is measured right after another one, as in a stream: with the contestant's own data in the caches and all its
/// cores awake, whatever the contestant before it did. A slow one sits out rounds, evenly spread. Ends early, with what
/// there is, when the user interrupts; contestants that had no turn by then are left out.
std::vector<Measurement> alternate(const StereoPair& pair, const Contestants& contestants, const Patience& patience);

}  // namespace disparityd::bench
