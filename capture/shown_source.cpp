// SPDX-License-Identifier: Apache-2.0
#include "capture/shown_source.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "base/words.h"

namespace disparityd::capture {
namespace {

constexpr const char* blanks = " \t\n\r";
constexpr const char* stars = "***";

/// Hides who stands in front of the host in addresses.
std::string without_users(std::string text) {
    constexpr std::string_view begin = "://";
    for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
        at += begin.size();
        const std::size_t end = std::min(text.find_first_of(" \t\n\r\"'/?", at), text.size());
        const auto sign = text.substr(at, end - at).rfind('@');
        if (sign != std::string::npos) {
            text.replace(at, sign, stars);
        }
    }
    return text;
}

/// Whether the text in front of a "=" is the name of a property that holds a secret, or who has it.
bool ends_in_secret(std::string_view text) {
    constexpr std::array names{"user-id",    "user-pw", "proxy-id", "proxy-pw",      "password", "passwd",
                               "passphrase", "secret",  "token",    "authorization", "cookie",   "cookies"};
    const auto last = text.find_last_not_of(blanks);
    const std::string found = base::lower_case(text.substr(0, last == std::string_view::npos ? 0 : last + 1));
    return std::any_of(names.begin(), names.end(), [&](const char* name) { return found.ends_with(name); });
}

/// Returns where a value ends that begins at `from`: "(type)", then a word or text in quotation marks.
std::size_t end_of_value(std::string_view text, std::size_t from) {
    if (from < text.size() && text[from] == '(') {
        from = std::min(text.find(')', from), text.size() - 1) + 1;
    }
    const char quote = from < text.size() && (text[from] == '"' || text[from] == '\'') ? text[from] : '\0';
    for (std::size_t at = quote == '\0' ? from : from + 1; at < text.size(); ++at) {
        if (text[at] == '\\') {
            ++at;
        } else if (quote == '\0' ? std::string_view(" \t\n\r\"'").find(text[at]) != std::string_view::npos
                                 : text[at] == quote) {
            return quote == '\0' ? at : at + 1;
        }
    }
    return text.size();
}

std::string without_secrets(std::string text) {
    for (auto at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
        if (ends_in_secret(std::string_view(text).substr(0, at))) {
            const std::size_t value = std::min(text.find_first_not_of(blanks, at + 1), text.size());
            text.replace(value, end_of_value(text, value) - value, stars);
        }
    }
    return text;
}

}  // namespace

std::string without_passwords(const std::string& text) {
    return without_secrets(without_users(text));
}

std::string shown_source(const std::string& uri) {
    return uri.starts_with("gst:") || uri.starts_with("gst?") ? without_passwords(uri) : uri;
}

}  // namespace disparityd::capture
