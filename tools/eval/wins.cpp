// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/wins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace disparityd::eval {
namespace {

const std::string suffix = ", fair";

/// Returns the entry of a row's method and back end, a new one where there is none yet.
Wins& entry_of(const Row& row, std::vector<Wins>& all) {
    const std::string method = row.method.substr(0, row.method.size() - suffix.size());
    const auto found = std::find_if(all.begin(), all.end(), [&](const Wins& entry) {
        return entry.method == method && entry.backend == row.backend;
    });
    return found == all.end() ? all.emplace_back(Wins{method, row.backend, {}}) : *found;
}

}  // namespace

std::string fair_name(const std::string& method) {
    return method + suffix;
}

bool is_fair(const Row& row) {
    return row.method.ends_with(suffix);
}

bool is_opencv(const Row& row) {
    return row.backend == "opencv";
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

std::vector<Wins> wins(const std::vector<Row>& rows) {
    std::vector<Wins> all;
    for (auto first = rows.begin(); first != rows.end();) {
        const auto last = std::find_if(first, rows.end(), [&](const Row& row) { return row.scene != first->scene; });
        const std::vector<Row> scene(first, last);
        const double best = best_of_opencv(scene);
        for (const Row& row : scene) {
            if (is_fair(row) && !is_opencv(row) && std::isfinite(best) && std::isfinite(row.accuracy.bad1_nonocc)) {
                entry_of(row, all).scenes.push_back({row.scene, row.accuracy.bad1_nonocc, best});
            }
        }
        first = last;
    }
    return all;
}

}  // namespace disparityd::eval
