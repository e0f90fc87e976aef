// SPDX-License-Identifier: Apache-2.0
#include "base/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/words.h"

namespace disparityd::base {

std::optional<double> parse_number(std::string_view text) {
    text = trim(text);
    if (text.starts_with('+')) {
        text.remove_prefix(1);
    }
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
        return std::nullopt;
    }
    return number;
}

std::string number_text(double number) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
    return {text.data(), end};
}

std::string fixed(double number, int decimals) {
    std::array<char, 64> text{};
    const auto end = std::to_chars(text.begin(), text.end(), number, std::chars_format::fixed, decimals);
    return end.ec == std::errc() ? std::string(text.data(), end.ptr) : "?";
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, std::string_view separators) {
    std::vector<double> numbers;
    for (;;) {
        const auto first = text.find_first_not_of(separators);
        if (first == std::string_view::npos) {
            return numbers;
        }
        text.remove_prefix(first);
        const auto end = std::min(text.find_first_of(separators), text.size());
        const auto number = parse_number(text.substr(0, end));
        if (!number) {
            return std::nullopt;
        }
        numbers.push_back(*number);
        text.remove_prefix(end);
    }
}

}  // namespace disparityd::base
