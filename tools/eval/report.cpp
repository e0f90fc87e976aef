// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/report.h"

#include <algorithm>
#include <ostream>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"
#include "tools/eval/means.h"

namespace disparityd::eval {
namespace {

std::vector<Figure> accuracy_figures() {
    return {{"bad-1.0 nonocc %", "bad1_nonocc"},
            {"bad-1.0 all %", "bad1_all"},
            {"bad-2.0 nonocc %", "bad2_nonocc"},
            {"bad-2.0 all %", "bad2_all"},
            {"D1 nonocc %", "d1_nonocc"},
            {"D1 all %", "d1_all"},
            {"density %", "density"},
            {"false near %", "false_near"},
            {"thin %", "thin_found"}};
}

/// Returns the values in the order of accuracy_figures().
std::vector<double> accuracy_values(const Accuracy& accuracy) {
    return {accuracy.bad1_nonocc, accuracy.bad1_all, accuracy.bad2_nonocc, accuracy.bad2_all,  accuracy.d1_nonocc,
            accuracy.d1_all,      accuracy.density,  accuracy.false_near,  accuracy.thin_found};
}

bool any_has_noise_level(const std::vector<Row>& rows) {
    return std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.noise_level.has_value(); });
}

std::vector<std::string> head_of_rows(bool with_noise_level) {
    std::vector<std::string> head{"scene", "method", "backend", "D"};
    for (const Figure& figure : accuracy_figures()) {
        head.push_back(figure.heading);
    }
    head.emplace_back("ms");
    if (with_noise_level) {
        head.emplace_back("noise level");
    }
    return head;
}

}  // namespace

Measurements measurements(const std::vector<Row>& rows) {
    Measurements measured{accuracy_figures(), {}};
    for (const Row& row : rows) {
        measured.rows.push_back({row.scene, row.method, row.backend, accuracy_values(row.accuracy)});
    }
    return measured;
}

void print_table(const std::vector<Row>& rows, bool markdown, std::ostream& to) {
    const bool with_noise_level = any_has_noise_level(rows);
    tools::Table table(head_of_rows(with_noise_level));
    const Measurements measured = measurements(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::vector<std::string> line{rows[i].scene, rows[i].method, rows[i].backend,
                                      std::to_string(rows[i].disparities)};
        append_figures(measured.rows[i].values, measured.figures, line);
        line.push_back(tools::fixed(rows[i].ms, 1));
        if (with_noise_level) {
            line.push_back(rows[i].noise_level ? std::to_string(*rows[i].noise_level) : "");
        }
        table.add(line);
    }
    for (const Mean& mean : means(measured)) {
        std::vector<std::string> line{"mean", mean.method, mean.backend, ""};
        append_figures(mean.values, measured.figures, line);
        line.emplace_back();
        if (with_noise_level) {
            line.emplace_back();
        }
        table.add(line);
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

nlohmann::ordered_json rows_json(const std::vector<Row>& rows) {
    const Measurements measured = measurements(rows);
    auto list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& row = rows[i];
        nlohmann::ordered_json object{
            {"scene", row.scene}, {"method", row.method}, {"backend", row.backend}, {"disparities", row.disparities}};
        add_figures(measured.rows[i].values, measured.figures, object);
        object["ms"] = rounded_number(row.ms);
        if (row.noise_level) {
            object["noise_level"] = *row.noise_level;
        }
        list.push_back(object);
    }
    return list;
}

void print_json(const nlohmann::ordered_json& json, std::ostream& to) {
    to << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

}  // namespace disparityd::eval
