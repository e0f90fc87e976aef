// SPDX-License-Identifier: Apache-2.0
#include "capture/text_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace disparityd::capture {

std::string read_text_file(const std::string& path, std::string_view what) {
    constexpr std::uintmax_t largest = 1U << 20U;
    const std::string where = std::string(what) + " " + path + ": ";
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
        throw std::invalid_argument(where + "no such file");
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw std::invalid_argument(where + "not a file");
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || size > largest) {
        throw std::invalid_argument(where + "found " + std::to_string(size) + " bytes, allowed are 1 MiB of text");
    }
    std::ifstream file(path, std::ios::binary);
    std::string text(static_cast<std::size_t>(size), '\0');
    if (!file.read(text.data(), static_cast<std::streamsize>(size))) {
        throw std::invalid_argument(where + "cannot be read: check its permissions");
    }
    const std::string start = lower_case(trim(std::string_view(text).substr(0, 200)));
    if (start.starts_with("<!doctype") || start.starts_with("<html") || start.starts_with("<head")) {
        throw std::invalid_argument(where +
                                    "found a web page: the download failed and an error page was saved; fetch the "
                                    "file again");
    }
    return text;
}

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

std::string shown(std::string_view text, std::size_t longest) {
    std::string line(text.substr(0, longest));
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return text.size() > longest ? line + "..." : line;
}

std::string_view trim(std::string_view text) {
    constexpr std::string_view blank = " \t\r\n\f\v";
    const auto first = text.find_first_not_of(blank);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return lower;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) {
            return parts;
        }
        text.remove_prefix(end + 1);
    }
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

}  // namespace disparityd::capture
