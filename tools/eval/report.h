// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/eval/accuracy.h"
#include "tools/eval/means.h"

namespace disparityd::eval {

/// One line of the result.
struct Row {
    std::string scene;
    std::string method;
    std::string backend;
    int disparities = 0;
    Accuracy accuracy;
    double ms = 0;
    std::optional<int> noise_level{};  ///< where it follows the pair's noise
};

/// Returns the figures of print_table() for each row, without disparities and times.
Measurements measurements(const std::vector<Row>& rows);

/// A line per row, then the mean over the scenes for each method and back end.
void print_table(const std::vector<Row>& rows, bool markdown, std::ostream& to);

/// Returns a list of objects: scene, method, backend, disparities, bad1_nonocc, bad1_all, bad2_nonocc, bad2_all,
/// d1_nonocc, d1_all, density, false_near, thin_found (all in percent, null where no pixel is judged), ms, and
/// noise_level where a row has it.
nlohmann::ordered_json rows_json(const std::vector<Row>& rows);

void print_json(const nlohmann::ordered_json& json, std::ostream& to);

}  // namespace disparityd::eval
