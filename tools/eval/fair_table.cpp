// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/fair_table.h"

#include <algorithm>
#include <limits>
#include <ostream>

#include "tools/command_line/table.h"

namespace disparityd::eval {
namespace {

const std::string suffix = ", fair";

bool is_fair(const Row& row) {
    return row.method.ends_with(suffix);
}

bool is_opencv(const Row& row) {
    return row.backend == "opencv";
}

/// The rows of one scene: those as they are, then the fair ones, each in the order of measuring.
std::vector<Row> in_columns(std::vector<Row> rows) {
    std::stable_partition(rows.begin(), rows.end(), [](const Row& row) { return !is_fair(row); });
    return rows;
}

double best_of_opencv(const std::vector<Row>& scene) {
    double best = std::numeric_limits<double>::infinity();
    for (const Row& row : scene) {
        if (is_fair(row) && is_opencv(row)) {
            best = std::min(best, row.accuracy.bad1_nonocc);
        }
    }
    return best;
}

std::string column_name(const Row& row) {
    const std::string backend = is_opencv(row) || row.backend == "cpu" ? "" : ' ' + row.backend;
    return row.method + backend;
}

std::string with_sign(double difference) {
    const std::string text = tools::fixed(difference, 2);
    return text[0] == '-' ? text : '+' + text;
}

/// Adds the scene's line; how many of ours are at most OpenCV's best.
int add_line(const std::vector<Row>& scene, tools::Table& table) {
    std::vector<std::string> line{scene.front().scene + " (" + std::to_string(scene.front().disparities) + ")"};
    for (const Row& row : scene) {
        line.push_back(tools::fixed(row.accuracy.bad1_nonocc, 2));
    }
    int reached = 0;
    for (const Row& row : scene) {
        if (is_fair(row) && !is_opencv(row)) {
            const double difference = row.accuracy.bad1_nonocc - best_of_opencv(scene);
            line.push_back(with_sign(difference));
            reached += difference <= 0 ? 1 : 0;
        }
    }
    table.add(line);
    return reached;
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

std::string fair_name(const std::string& method) {
    return method + suffix;
}

void print_fair_table(const std::vector<Row>& rows, bool markdown, std::ostream& to) {
    tools::Table table({});
    int reached = 0, judged = 0;
    for (auto first = rows.begin(); first != rows.end();) {
        const auto last = std::find_if(first, rows.end(), [&](const Row& row) { return row.scene != first->scene; });
        const std::vector<Row> scene = in_columns({first, last});
        if (first == rows.begin()) {
            table = tools::Table(head_for(scene));
        }
        reached += add_line(scene, table);
        judged += static_cast<int>(
            std::count_if(scene.begin(), scene.end(), [](const Row& row) { return is_fair(row) && !is_opencv(row); }));
        first = last;
    }
    markdown ? table.print_markdown(to) : table.print(to);
    to << '\n' << reached << " of " << judged << " results at most the best of OpenCV, every pixel judged\n";
}

}  // namespace disparityd::eval
