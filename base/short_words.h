// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace disparityd::base {

/// Returns the line with the middle of each word of more than 300 bytes replaced by "...": a name from outside may be
/// of any length, and what is wrong with it stands behind it. Cuts between characters of UTF-8.
inline std::string with_short_words(std::string_view line) {
    constexpr std::size_t longest = 301;  // with the blank before it
    constexpr std::size_t kept = 140;     // at each end
    const auto is_cut = [line](std::size_t at) { return (static_cast<unsigned char>(line[at]) & 0xc0U) == 0x80U; };
    std::string text;
    for (std::size_t begin = 0; begin < line.size();) {
        const std::size_t end = std::min(line.find(' ', begin + 1), line.size());
        if (end - begin <= longest) {
            text += line.substr(begin, end - begin);
        } else {
            std::size_t first = begin + kept;
            std::size_t last = end - kept;
            for (; first > begin && is_cut(first); --first) {
            }
            for (; last < end && is_cut(last); ++last) {
            }
            text += line.substr(begin, first - begin);
            text += "...";
            text += line.substr(last, end - last);
        }
        begin = end;
    }
    return text;
}

}  // namespace disparityd::base
