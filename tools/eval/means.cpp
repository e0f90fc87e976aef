// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/means.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"

namespace disparityd::eval {
namespace {

/// Returns the mean of one figure over the rows where it is known.
double mean_of_figure(const std::vector<const Measured*>& rows, std::size_t figure) {
    double sum = 0;
    int known = 0;
    for (const Measured* row : rows) {
        if (!std::isnan(row->values[figure])) {
            sum += row->values[figure];
            ++known;
        }
    }
    return known == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / known;
}

}  // namespace

std::vector<Mean> means(const Measurements& measured, const SceneFilter& counts) {
    std::vector<Mean> all;
    for (const Measured& first : measured.rows) {
        const auto is_same = [&first](const auto& other) {
            return other.method == first.method && other.backend == first.backend;
        };
        if (std::any_of(all.begin(), all.end(), is_same)) {
            continue;
        }
        std::vector<const Measured*> rows;
        for (const Measured& row : measured.rows) {
            if (is_same(row) && counts(row.scene)) {
                rows.push_back(&row);
            }
        }
        Mean& mean = all.emplace_back(Mean{first.method, first.backend, rows.size(), {}});
        for (std::size_t i = 0; i < measured.figures.size(); ++i) {
            mean.values.push_back(mean_of_figure(rows, i));
        }
    }
    return all;
}

std::vector<Mean> means(const Measurements& measured) {
    return means(measured, [](const std::string& /*scene*/) { return true; });
}

std::string figure_text(double value, int decimals) {
    return std::isnan(value) ? "-" : tools::fixed(value, decimals);
}

void append_figures(const std::vector<double>& values, const std::vector<Figure>& figures,
                    std::vector<std::string>& line) {
    for (std::size_t i = 0; i < figures.size(); ++i) {
        line.push_back(figure_text(values[i], figures[i].decimals));
    }
}

void add_figures(const std::vector<double>& values, const std::vector<Figure>& figures,
                 nlohmann::ordered_json& object) {
    for (std::size_t i = 0; i < figures.size(); ++i) {
        object[figures[i].key] = rounded_number(values[i]);
    }
}

nlohmann::ordered_json means_json(const std::vector<Mean>& means, const std::vector<Figure>& figures) {
    auto list = nlohmann::ordered_json::array();
    for (const Mean& mean : means) {
        nlohmann::ordered_json object{{"method", mean.method}, {"backend", mean.backend}, {"scenes", mean.scenes}};
        add_figures(mean.values, figures, object);
        list.push_back(object);
    }
    return list;
}

}  // namespace disparityd::eval
