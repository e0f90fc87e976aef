// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/bench/opencv_contestant.h"

namespace disparityd::bench {

/// Who is asked to match a pair, as the command line has it.
struct Selection {
    /// Names or their first parts ("cpu", "opencv/hh"); empty = all, naive only on pairs that it is done
    /// with soon.
    std::vector<std::string> contestants;
    std::vector<cpu::InstructionSet> instruction_sets;
    std::vector<int> threads;
};

/// Throws std::invalid_argument for a word that names nobody.
void check_contestants(const std::vector<std::string>& words);

/// The methods of the contestants that take options of matching; OpenCV's have their own.
std::vector<Method> methods_of(const std::vector<std::string>& words);

/// The instruction sets that a word names: "best", "all", or the name of one. Throws std::invalid_argument.
std::vector<cpu::InstructionSet> parse_instruction_sets(const std::string& word);

/// All contestants for a pair, each having matched one frame. `options_of` has the options of each method by the name
/// of our contestant. Whoever the machine has no memory for is left out with a note on stderr. Ends early, with those
/// that there are, when the user interrupts.
Contestants line_up(const StereoPair& pair, const Selection& selection,
                    const std::map<std::string, MatchOptions>& options_of, WorkerPools& pools);

}  // namespace disparityd::bench
