// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// A number with a decimal point, whatever the locale; the whole text must be one, and finite.
std::optional<double> parse_number(std::string_view text);

/// The shortest text that parse_number() turns into the same number.
std::string number_text(double number);

/// All numbers of a text that is nothing but numbers and the given separators; empty when it is not.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::string_view separators);

}  // namespace disparityd::capture
