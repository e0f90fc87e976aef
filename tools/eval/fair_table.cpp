// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/fair_table.h"

#include <algorithm>
#include <ostream>

#include "tools/command_line/table.h"
#include "tools/eval/means.h"
#include "tools/eval/wins.h"

namespace disparityd::eval {
namespace {

/// The rows of one scene: those as they are, then the fair ones, each in the order of measuring.
std::vector<Row> in_columns(std::vector<Row> rows) {
    std::stable_partition(rows.begin(), rows.end(), [](const Row& row) { return !is_fair(row); });
    return rows;
}

std::string column_name(const Row& row) {
    const std::string backend = is_opencv(row) || row.backend == "cpu" ? "" : ' ' + row.backend;
    return row.method + backend;
}

std::string with_sign(double difference) {
    const std::string text = figure_text(difference, 2);
    return text[0] == '-' ? text : '+' + text;
}

/// Returns the figures of one scene: bad-1.0 of every row, then ours less the best of OpenCV.
std::vector<double> values_of(const std::vector<Row>& scene) {
    std::vector<double> values(scene.size());
    std::transform(scene.begin(), scene.end(), values.begin(), [](const Row& row) { return row.accuracy.bad1_nonocc; });
    for (const Row& row : scene) {
        if (is_fair(row) && !is_opencv(row)) {
            values.push_back(row.accuracy.bad1_nonocc - best_of_opencv(scene));
        }
    }
    return values;
}

/// Adds a line; `rows` of its values are figures of a matcher, those after them are differences.
void add_values(const std::string& name, const std::vector<double>& values, std::size_t rows, tools::Table& table) {
    std::vector<std::string> line{name};
    for (std::size_t i = 0; i < values.size(); ++i) {
        line.push_back(i < rows ? figure_text(values[i], 2) : with_sign(values[i]));
    }
    table.add(line);
}

std::vector<std::string> head_for(const std::vector<Row>& scene) {
    std::vector<std::string> head{"scene (D)"};
    for (const Row& row : scene) {
        head.push_back(column_name(row));
    }
    for (const Row& row : scene) {
        if (is_fair(row) && !is_opencv(row)) {
            head.push_back(column_name(row) + " - best of OpenCV");
        }
    }
    return head;
}

}  // namespace

void print_fair_table(const std::vector<Row>& rows, bool markdown, std::ostream& to) {
    tools::Table table({});
    Measurements lines;
    std::size_t columns = 0, reached = 0, judged = 0;
    for (auto first = rows.begin(); first != rows.end();) {
        const auto last = std::find_if(first, rows.end(), [&](const Row& row) { return row.scene != first->scene; });
        const std::vector<Row> scene = in_columns({first, last});
        const std::vector<double> values = values_of(scene);
        if (first == rows.begin()) {
            table = tools::Table(head_for(scene));
            columns = scene.size();
            lines.figures.resize(values.size());
        }
        add_values(first->scene + " (" + std::to_string(first->disparities) + ")", values, columns, table);
        lines.rows.push_back({first->scene, "", "", values});
        reached += static_cast<std::size_t>(std::count_if(values.begin() + static_cast<std::ptrdiff_t>(columns),
                                                          values.end(), [](double less) { return less <= 0; }));
        judged += values.size() - columns;
        first = last;
    }
    for (const Mean& mean : means(lines)) {
        add_values("mean", mean.values, columns, table);
    }
    markdown ? table.print_markdown(to) : table.print(to);
    to << '\n' << reached << " of " << judged << " results at most the best of OpenCV, every pixel judged\n";
}

}  // namespace disparityd::eval
