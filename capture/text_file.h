// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::capture {

/// A small text file as a whole. Throws std::invalid_argument when it is missing, unreadable, larger than 1 MiB, or a
/// web page saved in place of the file; `what` names it in the message, such as "calibration".
std::string read_text_file(const std::string& path, std::string_view what);

}  // namespace disparityd::capture
