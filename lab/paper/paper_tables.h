// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "tools/bench/alternation.h"

namespace disparityd::lab {

/// Tables 1 and 2 of the paper with our columns, in Markdown, for those of its scenes that were measured: the paper's
/// times, naive code as it describes it and as the reference has it, ours with the best instruction set on one thread
/// and on most, and the speed-ups.
void print_paper_tables(const std::vector<bench::Measurement>& measurements, std::ostream& to);

}  // namespace disparityd::lab
