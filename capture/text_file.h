// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// A small text file as a whole. Throws std::invalid_argument when it is missing, unreadable, larger than 1 MiB, or a
/// web page saved in place of the file; `what` names it in the message, such as "calibration".
std::string read_text_file(const std::string& path, std::string_view what);

/// A number with a decimal point, whatever the locale; the whole text must be one, and finite.
std::optional<double> parse_number(std::string_view text);

/// The shortest text that parse_number() turns into the same number.
std::string number_text(double number);

/// Text from outside as a message shows it: cut after so many bytes, and no byte in it ends the line or moves the
/// cursor of a terminal.
std::string shown(std::string_view text, std::size_t longest = 60);

std::string_view trim(std::string_view text);
std::string lower_case(std::string_view text);
std::vector<std::string_view> split(std::string_view text, char separator);

/// All numbers of a text that is nothing but numbers and the given separators; empty when it is not.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::string_view separators);

}  // namespace disparityd::capture
