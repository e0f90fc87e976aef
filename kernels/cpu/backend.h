// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kernels/matcher.h"

namespace disparityd::cpu {

/// An instruction set of this machine that the kernels are built for.
struct InstructionSet {
    std::string name;         ///< as Highway has it: AVX3_DL, AVX3, AVX2, SSE4, NEON
    std::int64_t target = 0;  ///< Highway's bit
};

/// The best first; empty on a machine with none of them (the reference runs everywhere).
std::vector<InstructionSet> instruction_sets();

/// The back end `cpu` for one instruction set; create() of the table takes the best. Throws as Backend::create does.
std::unique_ptr<Matcher> create(const MatcherConfig& config, const InstructionSet& instruction_set);

bool available();
std::unique_ptr<Matcher> create_best(const MatcherConfig& config);

}  // namespace disparityd::cpu
