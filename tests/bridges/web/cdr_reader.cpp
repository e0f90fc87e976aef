// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/web/cdr_reader.h"

#include <stdexcept>

namespace disparityd::test {

CdrReader::CdrReader(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {
    if (bytes.size() < start ||
        std::vector(bytes.begin(), bytes.begin() + start) != std::vector<std::uint8_t>{0, 1, 0, 0}) {
        throw std::runtime_error("no header of little-endian CDR");
    }
}

const std::uint8_t* CdrReader::take(std::size_t size) {
    if (place_ > bytes_.size() || size > bytes_.size() - place_) {
        throw std::runtime_error("the message ends too soon");
    }
    place_ += size;
    return bytes_.data() + place_ - size;
}

std::string CdrReader::text() {
    const auto size = get<std::uint32_t>();
    const auto* first = reinterpret_cast<const char*>(take(size));
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
