// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/web/cdr_reader.h"

#include <stdexcept>
#include <utility>

namespace disparityd::test {

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) {
        text.push_back(static_cast<char>(value));
    }
    return text;
}

CdrReader::CdrReader(std::string bytes) : bytes_(std::move(bytes)) {
    if (bytes_.substr(0, start) != test::bytes({0, 1, 0, 0})) {
        throw std::runtime_error("no header of little-endian CDR");
    }
}

const char* CdrReader::take(std::size_t size) {
    if (place_ > bytes_.size() || size > bytes_.size() - place_) {
        throw std::runtime_error("the message ends too soon");
    }
    place_ += size;
    return bytes_.data() + place_ - size;
}

std::string CdrReader::text() {
    const auto size = get<std::uint32_t>();
    const char* first = take(size);
    if (size == 0 || first[size - 1] != 0) {
        throw std::runtime_error("a string does not end with 0");
    }
    return {first, size - 1};
}

std::string CdrReader::header() {
    const auto seconds = get<std::int32_t>();
    const auto nanoseconds = get<std::uint32_t>();
    return std::to_string(seconds) + "." + std::to_string(nanoseconds) + " " + text();
}

}  // namespace disparityd::test
