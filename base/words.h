// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::base {

/// Returns the text without the blanks and line ends around it.
std::string_view trim(std::string_view text);

/// Returns the text with A to Z in lower case, whatever the locale.
std::string lower_case(std::string_view text);

/// Returns the parts between the separators, at least one. The part between two adjacent separators is empty.
std::vector<std::string_view> split(std::string_view text, char separator);

/// Returns a number and what it counts, for people: "1 frame", "2 frames".
std::string counted(std::uint64_t number, std::string_view noun);

}  // namespace disparityd::base
