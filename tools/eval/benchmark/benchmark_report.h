// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <vector>

#include "tools/eval/benchmark/benchmark_rows.h"

namespace disparityd::eval {

enum class BenchmarkFormat : std::uint8_t { text, markdown, csv, json };

/// Prints the rows of the cells (rows_of()):
/// - text and Markdown: a line for each row;
/// - CSV (a head; cells quoted as in RFC 4180; a line feed ends a line): row, scene, matcher, region, scenes, pixels,
///   then the figures by their keys, four decimals, empty where not known;
/// - JSON: an object: holes, rows (a list of objects with the same keys, null where not known), and curves, a list of
///   objects: scene, matcher, region, removed_percent (0, 5 .. 95), error_px and best_px (Sparsification), where a
///   matcher has confidences.
void print_benchmark(const std::vector<BenchmarkCell>& cells, Holes holes, BenchmarkFormat format, std::ostream& to);

}  // namespace disparityd::eval
