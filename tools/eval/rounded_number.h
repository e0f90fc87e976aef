// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace disparityd::eval {

/// Four decimals are more than the pixels tell; the rest is noise of the number format.
inline nlohmann::ordered_json rounded_number(double value) {
    return std::isnan(value) ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(std::round(value * 1e4) / 1e4);
}

}  // namespace disparityd::eval
