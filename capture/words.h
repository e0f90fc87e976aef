// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// Without the blanks and line ends around it.
std::string_view trim(std::string_view text);

/// A to Z only, whatever the locale.
std::string lower_case(std::string_view text);

/// At least one part; those between two separators are empty.
std::vector<std::string_view> split(std::string_view text, char separator);

}  // namespace disparityd::capture
