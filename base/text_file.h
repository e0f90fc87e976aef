// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::base {

/// Reads a whole text file of at most 1 MiB. Leaves out the byte order mark that some editors write. Throws
/// std::invalid_argument when the file is missing, unreadable, larger, UTF-16, or a web page that was saved in its
/// place; `what` names the kind of file in the message, such as "calibration".
std::string read_text_file(const std::string& path, std::string_view what);

/// Returns the text behind a byte order mark of UTF-8; the whole text where there is none.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace disparityd::base
