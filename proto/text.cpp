// SPDX-License-Identifier: Apache-2.0
#include "proto/text.h"

#include <boost/locale/utf.hpp>

namespace disparityd::proto {

std::string text(std::string_view from) {
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

}  // namespace disparityd::proto
