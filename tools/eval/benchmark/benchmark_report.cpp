// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/benchmark_report.h"

#include <cmath>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "tools/command_line/csv.h"
#include "tools/command_line/table.h"
#include "tools/eval/means.h"
#include "tools/eval/report.h"

namespace disparityd::eval {
namespace {

void print_csv(const std::vector<BenchmarkRow>& rows, std::ostream& to) {
    constexpr int decimals = 4;
    to << "row,scene,matcher,region,scenes,pixels";
    for (const Figure& figure : benchmark_figures()) {
        to << ',' << figure.key;
    }
    to << '\n';
    for (const BenchmarkRow& row : rows) {
        to << name(row.kind) << ',' << tools::csv_quoted(row.scene) << ',' << tools::csv_quoted(row.matcher) << ','
           << name(row.region) << ',' << row.scenes << ',' << row.pixels;
        for (const double value : row.values) {
            to << ',' << (std::isnan(value) ? "" : base::fixed(value, decimals));
        }
        to << '\n';
    }
}

nlohmann::ordered_json row_json(const BenchmarkRow& row) {
    nlohmann::ordered_json object{{"row", name(row.kind)},      {"scene", row.scene},   {"matcher", row.matcher},
                                  {"region", name(row.region)}, {"scenes", row.scenes}, {"pixels", row.pixels}};
    if (row.kind != RowKind::scene) {
        object["scene"] = nullptr;
    }
    add_figures(row.values, benchmark_figures(), object);
    return object;
}

nlohmann::ordered_json curve_json(const BenchmarkCell& cell) {
    auto removed = nlohmann::ordered_json::array(), errors = removed, best = removed;
    for (std::size_t step = 0; step < Sparsification::steps; step += 5) {
        removed.push_back(step * 100 / Sparsification::steps);
        errors.push_back(rounded_number(cell.tally.curves->error_px[step]));
        best.push_back(rounded_number(cell.tally.curves->best_px[step]));
    }
    return {{"scene", cell.scene},        {"matcher", cell.matcher}, {"region", name(cell.region)},
            {"removed_percent", removed}, {"error_px", errors},      {"best_px", best}};
}

void print_as_json(const std::vector<BenchmarkCell>& cells, Holes holes, std::ostream& to) {
    auto rows = nlohmann::ordered_json::array(), curves = rows;
    for (const BenchmarkRow& row : rows_of(cells)) {
        rows.push_back(row_json(row));
    }
    for (const BenchmarkCell& cell : cells) {
        if (cell.tally.curves) {
            curves.push_back(curve_json(cell));
        }
    }
    print_json({{"holes", name(holes)}, {"rows", rows}, {"curves", curves}}, to);
}

void print_as_table(const std::vector<BenchmarkRow>& rows, bool markdown, std::ostream& to) {
    std::vector<std::string> head{"scene", "matcher", "region", "pixels"};
    for (const Figure& figure : benchmark_figures()) {
        head.push_back(figure.heading);
    }
    tools::Table table(head);
    for (const BenchmarkRow& row : rows) {
        const std::string scene =
            row.kind == RowKind::scene ? row.scene : std::string(name(row.kind)) + " of " + std::to_string(row.scenes);
        std::vector<std::string> line{scene, row.matcher, std::string(name(row.region)), std::to_string(row.pixels)};
        append_figures(row.values, benchmark_figures(), line);
        table.add(line);
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

}  // namespace

void print_benchmark(const std::vector<BenchmarkCell>& cells, Holes holes, BenchmarkFormat format, std::ostream& to) {
    switch (format) {
        case BenchmarkFormat::csv: print_csv(rows_of(cells), to); break;
        case BenchmarkFormat::json: print_as_json(cells, holes, to); break;
        case BenchmarkFormat::text:
        case BenchmarkFormat::markdown: print_as_table(rows_of(cells), format == BenchmarkFormat::markdown, to); break;
    }
}

}  // namespace disparityd::eval
