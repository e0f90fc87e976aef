// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace disparityd::capture {

/// Text from outside as a message shows it: cut after so many bytes, not within a character of UTF-8, and nothing in it
/// ends the line or moves the cursor of a terminal.
std::string shown(std::string_view text, std::size_t longest = 60);

/// Of an image, in pixels.
std::string size_text(int width, int height);

}  // namespace disparityd::capture
