// SPDX-License-Identifier: Apache-2.0
#include "formats/ros1_reader.h"

#include <algorithm>
#include <bit>

namespace disparityd::formats {

std::string_view Ros1Reader::text() {
    const auto bytes = elements(get<std::uint32_t>(), 1);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void Ros1Reader::take_number(std::span<std::uint8_t> into) {
    const auto bytes = elements(1, into.size());
    std::copy(bytes.begin(), bytes.end(), into.begin());
    if (std::endian::native == std::endian::big) {
        std::reverse(into.begin(), into.end());
    }
}

}  // namespace disparityd::formats
