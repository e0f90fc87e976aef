// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/host_and_port.h"

#include <charconv>

namespace disparityd::bridges {

std::optional<NameAndNumber> parse_name_and_number(std::string_view text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos || colon == 0) {
        return std::nullopt;
    }
    NameAndNumber read{std::string(text.substr(0, colon))};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + colon + 1, end, read.number);
    if (error != std::errc() || stop != end) {
        return std::nullopt;
    }
    return read;
}

std::optional<NameAndNumber> parse_host_and_port(std::string_view text) {
    std::optional<NameAndNumber> read = parse_name_and_number(text);
    if (read && read->name.size() > 2 && read->name.front() == '[' && read->name.back() == ']') {
        read->name = read->name.substr(1, read->name.size() - 2);
    }
    return read;
}

}  // namespace disparityd::bridges
