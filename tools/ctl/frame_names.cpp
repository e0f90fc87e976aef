// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/frame_names.h"

#include <algorithm>
#include <cstdio>

namespace disparityd::tools {
namespace {

/// File systems allow 255 bytes; an ending and a number follow the name.
constexpr std::size_t longest = 200;

std::string stem_of(std::string_view input) {
    const std::size_t dot = input.rfind('.');
    std::string stem(dot == std::string_view::npos || dot == 0 ? input : input.substr(0, dot));
    if (stem.size() > longest) {
        std::size_t size = longest;
        while (size > 0 && (static_cast<unsigned char>(stem[size]) & 0xc0U) == 0x80U) {
            --size;  // not within a character of UTF-8
        }
        stem.resize(size);
    }
    std::replace_if(
        stem.begin(), stem.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '/'; }, '_');
    return stem;
}

}  // namespace

std::string FrameNames::next(std::string_view input) {
    const std::uint64_t number = count_++;
    if (input.empty()) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%06llu", static_cast<unsigned long long>(number));
        return digits;
    }
    const std::string stem = stem_of(input);
    std::string name = stem;
    for (int i = 2; taken_.contains(name) || taken_.contains(name + "_colour"); ++i) {
        name = stem + '-' + std::to_string(i);
    }
    taken_.insert(name);
    taken_.insert(name + "_colour");
    return name;
}

}  // namespace disparityd::tools
