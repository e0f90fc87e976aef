// SPDX-License-Identifier: Apache-2.0
#include "proto/text.h"

#include <boost/locale/utf.hpp>

namespace disparityd::proto {

std::string to_valid_utf8(std::string_view from) {
    namespace utf = boost::locale::utf;
    std::string valid;
    valid.reserve(from.size());
    const char* at = from.data();
    const char* const end = at + from.size();
    while (at != end) {
        const char* next = at;
        if (utf::is_valid_codepoint(utf::utf_traits<char>::decode(next, end))) {
            valid.append(at, next);
            at = next;
        } else {
            valid += '?';
            ++at;
        }
    }
    return valid;
}

std::string to_printable_utf8(std::string_view from) {
    std::string line = to_valid_utf8(from);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const auto byte = [&line](std::size_t at) {
            return at < line.size() ? static_cast<unsigned char>(line[at]) : 0U;
        };
        if (byte(i) < 0x20 || byte(i) == 0x7f) {
            line[i] = '?';
        } else if (byte(i) == 0xc2 && byte(i + 1) < 0xa0) {
            line.replace(i, 2, "?");  // U+0080 to U+009F
        }
    }
    return line;
}

}  // namespace disparityd::proto
