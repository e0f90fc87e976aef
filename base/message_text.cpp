// SPDX-License-Identifier: Apache-2.0
#include "base/message_text.h"

#include <algorithm>

namespace disparityd::base {
namespace {

/// Returns whether a byte belongs to a character of UTF-8 and is not its first.
bool continues_character(unsigned byte) {
    return (byte & 0xc0U) == 0x80U;
}

constexpr std::size_t most_that_continue = 3;

/// Returns whether these three bytes are a character that changes the direction or the line of the text after it:
/// U+200E, U+200F, U+2028 to U+202E and U+2066 to U+2069.
bool rearranges_text(unsigned first, unsigned second, unsigned third) {
    return first == 0xe2 && ((second == 0x80 && (third == 0x8e || third == 0x8f || (third >= 0xa8 && third <= 0xae))) ||
                             (second == 0x81 && third >= 0xa6 && third <= 0xa9));
}

}  // namespace

std::string printable(std::string_view text, std::size_t longest) {
    const auto byte = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    std::size_t size = std::min(longest, text.size());
    while (size > 0 && longest - size < most_that_continue && continues_character(byte(size))) {
        --size;
    }
    std::string line(text.substr(0, size));
    for (std::size_t i = 0; i < size; ++i) {
        if (byte(i) < 0x20 || byte(i) == 0x7f) {
            line[i] = '?';
        } else if (byte(i) == 0xc2 && continues_character(byte(i + 1)) && byte(i + 1) < 0xa0) {
            line.replace(i, 2, "??");  // U+0080 to U+009F are control characters, too
        } else if (i + 2 < size && rearranges_text(byte(i), byte(i + 1), byte(i + 2))) {
            line.replace(i, 3, "???");
        }
    }
    return size < text.size() ? line + "..." : line;
}

std::string printable_line(std::string_view line) {
    constexpr std::size_t longest = 301;  // with the blank before it
    constexpr std::size_t kept = 140;     // at each end
    const std::string whole = printable(line, line.size());
    const auto is_cut = [&whole](std::size_t at) { return continues_character(static_cast<unsigned char>(whole[at])); };
    std::string text;
    for (std::size_t begin = 0; begin < whole.size();) {
        const std::size_t end = std::min(whole.find(' ', begin + 1), whole.size());
        if (end - begin <= longest) {
            text.append(whole, begin, end - begin);
        } else {
            std::size_t first = begin + kept;
            std::size_t last = end - kept;
            for (; first > begin && is_cut(first); --first) {
            }
            for (; last < end && is_cut(last); ++last) {
            }
            text.append(whole, begin, first - begin);
            text += "...";
            text.append(whole, last, end - last);
        }
        begin = end;
    }
    return text;
}

std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace disparityd::base
