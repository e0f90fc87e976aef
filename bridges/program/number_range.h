// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

namespace disparityd::bridges {

/// Refuses what is outside, and what is no number ("nan" is not between others).
inline CLI::Validator between(double least, double most) {
    std::ostringstream allowed;
    allowed << "allowed: " << least << " .. " << most;
    return CLI::Validator(
        [least, most, text = allowed.str()](const std::string& value) {
            double number = 0;
            const bool good = CLI::detail::lexical_cast(value, number) && number >= least && number <= most;
            return good ? std::string() : "found " + value + ", " + text;
        },
        "", "");
}

}  // namespace disparityd::bridges
