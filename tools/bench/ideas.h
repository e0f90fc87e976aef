// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/bench/alternation.h"
#include "tools/command_line/table.h"

namespace disparityd::bench {

/// What one idea gives: the same result computed without it and with it.
struct Idea {
    std::string idea;
    std::string compared;  ///< what exactly, without and with
    double without_ms = 0;
    double with_ms = 0;
};

/// Measures each idea of the paper, and ours beyond it, on a pair: without and with in alternation. `threads` of the
/// idea to use them. Ends early, with those that there are, when the user interrupts.
std::vector<Idea> measure_ideas(const StereoPair& pair, const Patience& patience, int threads, WorkerPools& pools);

tools::Table idea_table(const std::vector<Idea>& ideas);

}  // namespace disparityd::bench
