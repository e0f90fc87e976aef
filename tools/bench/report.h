// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "tools/bench/alternation.h"
#include "tools/command_line/table.h"

namespace disparityd::bench {

/// Where the numbers come from: lines about the machine, OpenCV and what is counted.
void print_head(bool markdown, std::ostream& to);

/// Prints a table for people, or as Markdown.
void print(const tools::Table& table, bool markdown, std::ostream& to);

/// One pair's line of title and its table; the ratios are of medians, more than 1 = faster than that contestant. The
/// naive version of the same method, as compiled and not vectorised; 3WAY with the same number of threads.
void print_measurements(const std::vector<Measurement>& measurements, bool markdown, std::ostream& to);

/// A list of objects: name, isa, scene, width, height, disparities, threads, median_ms, min_ms, q1_ms, q3_ms, cpu_ms,
/// runs, frames_per_s, gde_per_s, memory_mb (null where it is not known).
void print_json(const std::vector<Measurement>& measurements, std::ostream& to);

/// The measurement of that name; any instruction set when `isa` is empty. nullptr: there is none.
const Measurement* find(const std::vector<Measurement>& measurements, const std::string& name, const std::string& isa,
                        int threads);

}  // namespace disparityd::bench
