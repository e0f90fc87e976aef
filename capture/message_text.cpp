// SPDX-License-Identifier: Apache-2.0
#include "capture/message_text.h"

#include <algorithm>

namespace disparityd::capture {

std::string shown(std::string_view text, std::size_t longest) {
    std::string line(text.substr(0, longest));
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return text.size() > longest ? line + "..." : line;
}

std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace disparityd::capture
