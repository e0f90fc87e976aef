// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/matcher.h"

namespace disparityd::eval {

/// What `disparity-eval --temporal-report sequences:SEED` runs: rendered sequences, before and after step 17 of
/// docs/algorithm.md.
struct TemporalEvaluation {
    std::uint32_t seed = 1;  ///< of the first sequence; that of each further one is higher by 2
    int sequences = 4;       ///< of each kind
    MatchOptions match;
    const Backend* backend = nullptr;
};

/// Returns the seed of sequences:SEED. Throws std::invalid_argument for other DATA.
std::uint32_t seed_of_sequences(const std::vector<std::string>& data);

/// Plays all sequences and prints a table: a row for each kind and noise.
void report_temporal(const TemporalEvaluation& evaluation, Parallel& workers, bool markdown);

}  // namespace disparityd::eval
