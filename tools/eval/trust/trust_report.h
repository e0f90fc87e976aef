// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernels/matcher.h"
#include "tools/eval/trust/made_faults.h"

namespace disparityd::eval {

/// Made sequences of faulty and of good eyes, and what a frame's doubts say of them (step 15 of docs/algorithm.md).
struct TrustEvaluation {
    std::uint32_t seed = 1;    ///< of the first sequence; that of each further one is higher by 2
    int sequences = 30;        ///< of each fault, and good ones
    std::string size = "vga";  ///< of the rendered scene
    MatchOptions match;
    const Backend* backend = nullptr;
};

/// What was said of the sequences of one fault.
struct TrustCount {
    int sequences = 0;
    int named = 0;                    ///< within 5 s of the fault's beginning, at 15 frames/s
    double slowest_s = 0;             ///< of those that were named
    int alarms_before = 0;            ///< sequences with an alarm before the fault began
    int others = 0;                   ///< sequences with an alarm of another kind
    std::vector<std::string> missed;  ///< one line for each sequence that was not named, or had another alarm
};

/// Plays the sequences of one fault. Of good ones, for ten minutes together, `others` counts all alarms.
TrustCount count_trust(const TrustEvaluation& evaluation, Fault fault, Parallel& workers);

/// Returns the seed of faults:SEED, nothing for other DATA. Throws std::invalid_argument for a bad one.
std::optional<std::uint32_t> seed_of_faults(const std::vector<std::string>& data);

/// Plays real pairs, each for 20 s as a robot that stands sees it, and prints what is said of them. DATA: folders of
/// scenes with ground truth, or LEFT,RIGHT of a rectified pair. Throws std::invalid_argument for other DATA.
void report_trust_of_data(const TrustEvaluation& evaluation, const std::vector<std::string>& data, Parallel& workers,
                          bool markdown);

/// Plays the sequences of all faults and the good ones, and prints a table.
void report_trust(const TrustEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
