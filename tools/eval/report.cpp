// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/report.h"

#include <cmath>
#include <ostream>

#include <nlohmann/json.hpp>

#include "tools/command_line/table.h"
#include "tools/eval/rounded_number.h"

namespace disparityd::eval {
namespace {

using tools::fixed;

std::string percent(double value) {
    return std::isnan(value) ? "-" : fixed(value, 2);
}

}  // namespace

void print_table(const std::vector<Row>& rows, bool markdown, std::ostream& to) {
    tools::Table table({"scene", "method", "backend", "D", "bad-1.0 nonocc %", "bad-1.0 all %", "bad-2.0 nonocc %",
                        "bad-2.0 all %", "density %", "ms"});
    for (const Row& row : rows) {
        const Accuracy& accuracy = row.accuracy;
        table.add({row.scene, row.method, row.backend, std::to_string(row.disparities), percent(accuracy.bad1_nonocc),
                   percent(accuracy.bad1_all), percent(accuracy.bad2_nonocc), percent(accuracy.bad2_all),
                   percent(accuracy.density), fixed(row.ms, 1)});
    }
    markdown ? table.print_markdown(to) : table.print(to);
}

void print_json(const std::vector<Row>& rows, std::ostream& to) {
    auto list = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
        const Accuracy& accuracy = row.accuracy;
        list.push_back({{"scene", row.scene},
                        {"method", row.method},
                        {"backend", row.backend},
                        {"disparities", row.disparities},
                        {"bad1_nonocc", rounded_number(accuracy.bad1_nonocc)},
                        {"bad1_all", rounded_number(accuracy.bad1_all)},
                        {"bad2_nonocc", rounded_number(accuracy.bad2_nonocc)},
                        {"bad2_all", rounded_number(accuracy.bad2_all)},
                        {"density", rounded_number(accuracy.density)},
                        {"ms", rounded_number(row.ms)}});
    }
    to << list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

}  // namespace disparityd::eval
