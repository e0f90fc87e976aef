// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "tools/eval/report.h"

namespace disparityd::eval {

/// One line per scene: bad-1.0 over non-occluded pixels of every method as it is, and then of every one on even terms;
/// last, how much less or more each of ours has than the best of OpenCV. Then a line with the mean of each column over
/// the scenes, and how many of ours are at most the best of OpenCV.
void print_fair_table(const std::vector<Row>& rows, bool markdown, std::ostream& to);

}  // namespace disparityd::eval
