// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tools/command_line/table.h"

namespace disparityd::eval {

/// A share in per cent; "-" of nothing.
inline std::string percent(double part, double whole, int decimals) {
    return whole > 0 ? tools::fixed(100 * part / whole, decimals) : "-";
}

/// The value that this share of all values is at most, in per cent; "-" where there is none.
inline std::string percent_at(std::vector<double> values, double share) {
    if (values.empty()) {
        return "-";
    }
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return tools::fixed(100 * values[static_cast<std::size_t>(at)], 1);
}

}  // namespace disparityd::eval
