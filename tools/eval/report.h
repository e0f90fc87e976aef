// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/eval/accuracy.h"

namespace disparityd::eval {

/// One line of the result.
struct Row {
    std::string scene;
    std::string method;
    std::string backend;
    int disparities = 0;
    Accuracy accuracy;
    double ms = 0;
};

void print_table(const std::vector<Row>& rows, bool markdown, std::ostream& to);

/// A list of objects: scene, method, backend, disparities, bad1_nonocc, bad1_all, bad2_nonocc, bad2_all, density (all
/// in percent, null where no pixel is judged), ms.
void print_json(const std::vector<Row>& rows, std::ostream& to);

}  // namespace disparityd::eval
