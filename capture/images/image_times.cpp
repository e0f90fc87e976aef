// SPDX-License-Identifier: Apache-2.0
#include "capture/images/image_times.h"

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"

namespace disparityd::capture {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

/// Reads an unsigned number from the front; false when there is none.
bool take_number(std::string_view& text, int& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || number < 0) {
        return false;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

bool take(std::string_view& text, char separator) {
    if (text.empty() || text.front() != separator) {
        return false;
    }
    text.remove_prefix(1);
    return true;
}

/// Reads a time such as "2011-09-26 13:02:25.964389445".
std::optional<std::int64_t> parse_date(std::string_view text) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (!take_number(text, year) || !take(text, '-') || !take_number(text, month) || !take(text, '-') ||
        !take_number(text, day) || !take(text, ' ') || !take_number(text, hour) || !take(text, ':') ||
        !take_number(text, minute) || !take(text, ':') || !take_number(text, second)) {
        return std::nullopt;
    }
    std::int64_t fraction = 0;
    if (take(text, '.')) {
        std::int64_t unit = second_ns;
        while (!text.empty() && text.front() >= '0' && text.front() <= '9' && unit > 1) {
            unit /= 10;
            fraction += unit * (text.front() - '0');
            text.remove_prefix(1);
        }
    }
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (!text.empty() || !date.ok() || year < 1970 || year > 2200 || hour > 23 || minute > 59 || second > 60) {
        return std::nullopt;
    }
    const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
    return (((days * 24 + hour) * 60 + minute) * 60 + second) * second_ns + fraction;
}

std::optional<std::int64_t> parse_seconds(std::string_view text) {
    double seconds = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || end != text.data() + text.size() || !(seconds >= 0 && seconds < 1e9)) {
        return std::nullopt;
    }
    return std::llround(seconds * 1e9);
}

}  // namespace

std::vector<std::int64_t> read_image_times(const std::string& path, std::size_t count) {
    std::ifstream file(path);
    if (!file) {
        throw std::invalid_argument(path + ": cannot be read: " + base::error_text(errno));
    }
    std::vector<std::int64_t> times;
    std::string line;
    while (std::getline(file, line)) {
        if (times.empty()) {
            line.erase(0, line.size() - base::without_byte_order_mark(line).size());
        }
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
            line.pop_back();
        }
        if (line.empty()) {
            continue;
        }
        const std::optional<std::int64_t> time =
            line.find(':') != std::string::npos ? parse_date(line) : parse_seconds(line);
        const std::string where = path + ": time " + std::to_string(times.size() + 1);
        if (!time) {
            throw std::invalid_argument(where + ": found '" + base::printable(line) +
                                        "', expected seconds or a date such as 2011-09-26 13:02:25.964389445");
        }
        if (!times.empty() && *time < times.back()) {
            throw std::invalid_argument(where + ": lies before the time above it: " + line.substr(0, 60));
        }
        times.push_back(*time);
    }
    if (times.size() != count) {
        throw std::invalid_argument(path + ": found " + base::counted(times.size(), "time") + " for " +
                                    base::counted(count, "frame"));
    }
    return times;
}

std::optional<std::int64_t> take_time(std::string_view& line) {
    constexpr std::size_t longest = 18;  // digits of ns that fit beside EuRoC's 19
    const auto comma = line.find(',');
    const std::string_view digits = base::trim(line.substr(0, comma));
    if (comma == std::string_view::npos || digits.empty() || digits.size() > longest + 1 ||
        (digits.size() == longest + 1 && digits.front() == '9') ||
        digits.find_first_not_of("0123456789") != std::string_view::npos) {
        return std::nullopt;
    }
    line.remove_prefix(comma + 1);
    return std::stoll(std::string(digits));
}

}  // namespace disparityd::capture
