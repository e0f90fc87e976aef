// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace disparityd::tools {

/// Returns a text as a field of CSV (RFC 4180): in quotation marks where it has a comma, a quotation mark or a line
/// end.
std::string csv_quoted(std::string_view text);

/// The same with "?" for control characters, so that a record stays one line.
std::string csv_field(std::string_view text);

/// Returns the fields of one line, without their quotation marks.
std::vector<std::string> csv_fields(std::string_view line);

}  // namespace disparityd::tools
