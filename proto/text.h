// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::proto {

/// Returns text from outside (a file's name, what a device says) as a string of a message: bytes that are not UTF-8
/// become "?". A receiver refuses the whole message otherwise.
std::string to_valid_utf8(std::string_view from);

/// Returns to_valid_utf8() of what the other side says, as one line: control characters, which move the cursor of a
/// terminal, become "?".
std::string to_printable_utf8(std::string_view from);

}  // namespace disparityd::proto
