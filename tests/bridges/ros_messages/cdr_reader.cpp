// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/ros_messages/cdr_reader.h"

namespace disparityd::test {

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) {
        text.push_back(static_cast<char>(value));
    }
    return text;
}

CdrReader::CdrReader(const std::string& message)
    : std::string(message),
      formats::CdrReader(std::span(reinterpret_cast<const std::uint8_t*>(std::string::data()), std::string::size())) {}

std::string CdrReader::header() {
    const auto seconds = get<std::int32_t>();
    const auto nanoseconds = get<std::uint32_t>();
    return std::to_string(seconds) + "." + std::to_string(nanoseconds) + " " + std::string(text());
}

}  // namespace disparityd::test
