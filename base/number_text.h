// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::base {

/// Reads a number with a decimal point, whatever the locale. Returns nothing unless the whole text is a finite number.
std::optional<double> parse_number(std::string_view text);

/// Returns the shortest text that parse_number() turns into the same number.
std::string number_text(double number);

/// Returns the number with so many decimals, whatever the locale.
std::string fixed(double number, int decimals);

/// Reads a text of numbers between any of the given separators. Returns nothing when the text holds anything else.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::string_view separators);

}  // namespace disparityd::base
