// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/toml_text.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <map>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <toml.hpp>

#include "daemon/config/toml_depth.h"

namespace disparityd::daemon {
namespace {

/// In the order of names, so that of several mistakes the same one is told each time.
using Value = toml::basic_value<toml::discard_comments, std::map, std::vector>;

std::string position(const std::string& name, std::size_t line, std::size_t column) {
    return name + ':' + std::to_string(line) + ':' + std::to_string(column);
}

/// Returns where a key stands. toml11 knows only where its value begins, which is on the same line.
std::string position_of_key(const std::string& name, std::string_view key, const Value& value) {
    const toml::source_location at = value.location();
    const std::string_view before = std::string_view(at.line_str()).substr(0, at.column() - 1);
    const auto found = before.rfind(key);
    return position(name, at.line(), found == std::string_view::npos ? at.column() : found + 1);
}

/// Returns where a section's header begins; toml11 tells where its name does.
std::string position_of_section(const std::string& name, const Value& section) {
    const toml::source_location at = section.location();
    const auto bracket = std::string_view(at.line_str()).find('[');
    return position(name, at.line(), bracket == std::string_view::npos ? at.column() : bracket + 1);
}

/// Returns a list of whole numbers or of texts; an empty one is one of numbers.
std::optional<ConfigValue> to_list(const Value::array_type& elements) {
    std::vector<std::int64_t> numbers;
    std::vector<std::string> texts;
    for (const Value& element : elements) {
        if (element.is_integer()) {
            numbers.push_back(element.as_integer());
        } else if (element.is_string()) {
            texts.push_back(element.as_string().str);
        }
    }
    if (texts.size() == elements.size() && !texts.empty()) {
        return texts;
    }
    return numbers.size() == elements.size() ? std::optional<ConfigValue>(numbers) : std::nullopt;
}

std::optional<ConfigValue> to_value(const Value& value) {
    if (value.is_string()) {
        return value.as_string().str;
    }
    if (value.is_integer()) {
        return value.as_integer();
    }
    if (value.is_boolean()) {
        return value.as_boolean();
    }
    if (value.is_floating()) {
        return value.as_floating();
    }
    if (!value.is_array()) {
        return std::nullopt;
    }
    return to_list(value.as_array());
}

TomlSetting to_setting(std::string_view key, const Value& value, std::string where) {
    TomlSetting setting{std::string(key), to_value(value), {}, std::move(where)};
    if (setting.value) {
        setting.found = to_text(*setting.value);
    } else {
        std::ostringstream type;
        type << "a value of type " << value.type();
        setting.found = type.str();
    }
    return setting;
}

/// Returns the length of the character of UTF-8 that begins here; 0 where there is none (The Unicode Standard 15,
/// table 3-7).
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
    const auto follows = [&](std::size_t i, unsigned least = 0x80, unsigned most = 0xbf) {
        return byte(i) >= least && byte(i) <= most;
    };
    const unsigned first = byte(0);
    if (first < 0x80) {
        return 1;
    }
    if (first >= 0xc2 && first <= 0xdf) {
        return follows(1) ? 2 : 0;
    }
    if (first >= 0xe0 && first <= 0xef) {
        return follows(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf) && follows(2) ? 3 : 0;
    }
    if (first >= 0xf0 && first <= 0xf4) {
        return follows(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

/// toml11 3.7 reads beyond its text where a string is not UTF-8, so such a text is refused before.
void check_utf8(std::string_view text, const std::string& name) {
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = character_length(text.substr(i));
        if (length == 0) {
            const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
            throw std::invalid_argument(name + ':' + std::to_string(line) +
                                        ": found a byte that is not UTF-8, allowed: UTF-8; save the text as that");
        }
        i += length;
    }
}

/// Returns what toml11 says in its first line, without its name for the place in its own code.
std::string reason(const std::exception& error) {
    std::string text = error.what();
    text.resize(std::min(text.find('\n'), text.size()));
    if (const auto begin = text.find("toml::"); begin != std::string::npos) {
        const auto colon = text.find(": ", begin);
        text = colon == std::string::npos ? "" : text.substr(colon + 2);
    }
    return text.empty() ? "" : ": " + text;
}

[[noreturn]] void refuse(const std::string& where, const std::string& why) {
    if (why.find("already exists") != std::string::npos) {
        throw std::invalid_argument(where + why + " allowed: each key and each section once");
    }
    throw std::invalid_argument(where + ": this is not TOML" + why +
                                "; allowed: [section] lines and key = value lines");
}

Value parse(const std::string& text, const std::string& name) {
    if (text.size() > longest_toml) {
        throw std::invalid_argument(name + ": found " + std::to_string(text.size()) + " bytes, allowed: at most " +
                                    std::to_string(longest_toml));
    }
    check_utf8(text, name);
    if (const std::string problem = toml_depth_problem(text, name); !problem.empty()) {
        throw std::invalid_argument(problem);
    }
    std::istringstream stream(text);
    try {
        return toml::parse<toml::discard_comments, std::map, std::vector>(stream, name);
    } catch (const toml::exception& error) {
        refuse(position(name, error.location().line(), error.location().column()), reason(error));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {  // such as a number that std::stod cannot hold
        refuse(name, reason(error));
    }
}

}  // namespace

std::vector<TomlSection> parse_toml(const std::string& text, const std::string& name) {
    const Value file = parse(text, name);
    std::vector<TomlSection> sections;
    for (const auto& [section_name, content] : file.as_table()) {
        TomlSection& section = sections.emplace_back();
        section.name = section_name;
        section.is_table = content.is_table();
        if (!section.is_table) {
            section.where = position_of_key(name, section_name, content);
            continue;
        }
        section.where = position_of_section(name, content);
        for (const auto& [key, value] : content.as_table()) {
            section.settings.push_back(to_setting(key, value, position_of_key(name, key, value)));
        }
    }
    return sections;
}

std::optional<TomlSetting> parse_toml_value(const std::string& text, const std::string& name) {
    try {
        const Value parsed = parse("value = " + text, name);
        const auto& table = parsed.as_table();
        if (table.size() == 1 && table.begin()->first == "value") {
            return to_setting("value", table.begin()->second, name);
        }
    } catch (const std::invalid_argument&) {
        // The caller says which key it was for, and what is allowed there.
    }
    return std::nullopt;
}

}  // namespace disparityd::daemon
