// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace disparityd::base {

/// Returns text from outside for a line of a message: at most `longest` bytes of it, cut between characters of UTF-8
/// and marked with "...". Each byte of a control character, which would end the line or move the cursor of a terminal,
/// becomes "?". Bytes that are not UTF-8 stay.
std::string printable(std::string_view text, std::size_t longest = 60);

/// Returns one line for people: printable, whole, but for the middle of each word of more than 300 bytes, which becomes
/// "...": a name from outside may be of any length, and what is wrong with it stands behind it.
std::string printable_line(std::string_view line);

/// Returns the size of an image in pixels, such as "1280x720".
std::string size_text(int width, int height);

}  // namespace disparityd::base
