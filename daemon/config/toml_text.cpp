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

#include <openssl/asn1.h>

#include "daemon/config/toml_depth.h"
#include "daemon/config/toml_library.h"

namespace disparityd::daemon {
namespace {

using Value = toml::value;

std::string position(const std::string& name, const TomlPlace& at) {
    return name + ':' + std::to_string(at.line) + ':' + std::to_string(at.column);
}

/// The lines of a text that was parsed, and the name that messages give it.
class NamedLines {
public:
    NamedLines(std::string_view text, const std::string& name) : name_(name) {
        for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
            end = text.find('\n', begin);
            lines_.push_back(text.substr(begin, end - begin));
        }
    }

    const std::string& name() const { return name_; }
    /// Counts from 1; one that is not there is empty.
    std::string_view line(std::size_t number) const {
        return number >= 1 && number <= lines_.size() ? lines_[number - 1] : std::string_view();
    }

private:
    std::vector<std::string_view> lines_;
    const std::string& name_;
};

/// Returns where a key stands. toml11 knows only where its value begins, which is on the same line.
std::string position_of_key(const NamedLines& file, std::string_view key, const Value& value) {
    TomlPlace at = place_of(value.location());
    const auto found = file.line(at.line).substr(0, at.column - 1).rfind(key);
    at.column = found == std::string_view::npos ? at.column : found + 1;
    return position(file.name(), at);
}

/// Returns where a section's header begins; toml11 tells where its name does.
std::string position_of_section(const NamedLines& file, const Value& section) {
    TomlPlace at = place_of(section.location());
    const auto bracket = file.line(at.line).find('[');
    at.column = bracket == std::string_view::npos ? at.column : bracket + 1;
    return position(file.name(), at);
}

/// Returns the entries of a table in the order of their names, so that of several mistakes the same one is told each
/// time.
std::map<std::string_view, const Value*> entries_of(const Value& table) {
    std::map<std::string_view, const Value*> entries;
    for (const auto& [key, value] : table.as_table()) {
        entries.emplace(key, &value);
    }
    return entries;
}

/// Returns a list of whole numbers or of texts; an empty one is one of numbers.
std::optional<ConfigValue> to_list(const toml::array& elements) {
    std::vector<std::int64_t> numbers;
    std::vector<std::string> texts;
    for (const Value& element : elements) {
        if (element.is_integer()) {
            numbers.push_back(element.as_integer());
        } else if (element.is_string()) {
            texts.push_back(string_of(element));
        }
    }
    if (texts.size() == elements.size() && !texts.empty()) {
        return texts;
    }
    return numbers.size() == elements.size() ? std::optional<ConfigValue>(numbers) : std::nullopt;
}

std::optional<ConfigValue> to_value(const Value& value) {
    if (value.is_string()) {
        return string_of(value);
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

/// toml11 3.7 reads beyond its text where a string is not UTF-8, so such a text is refused before.
void check_utf8(std::string_view text, const std::string& name) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(text.data());
    for (std::size_t i = 0; i < text.size();) {
        unsigned long character = 0;
        const int length = UTF8_getc(bytes + i, static_cast<int>(text.size() - i), &character);
        if (length <= 0) {
            const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
            throw std::invalid_argument(name + ':' + std::to_string(line) +
                                        ": found a byte that is not UTF-8, allowed: UTF-8; save the text as that");
        }
        i += static_cast<std::size_t>(length);
    }
}

/// Returns what toml11 says, without its name for the place in its own code.
std::string reason(std::string text) {
    text.resize(std::min(text.find('\n'), text.size()));
    if (const auto begin = text.find("toml::"); begin != std::string::npos) {
        const auto colon = text.find(": ", begin);
        text = colon == std::string::npos ? "" : text.substr(colon + 2);
    }
    return text.empty() ? "" : ": " + text;
}

[[noreturn]] void refuse(const std::string& where, std::string why) {
    // "exists" in all versions of toml11, "defined" and "closed" in 4.
    for (const char* const twice : {"already exists", "already defined", "already closed"}) {
        if (why.find(twice) != std::string::npos) {
            why.resize(why.find_last_not_of(". ") + 1);
            throw std::invalid_argument(where + why + "; allowed: each key and each section once");
        }
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
    try {
        return parse_with_library(text, name);
    } catch (const TomlLibraryError& error) {
        refuse(position(name, place_of(error)), reason(title_of(error)));
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {  // such as a number that std::stod cannot hold
        refuse(name, reason(error.what()));
    }
}

}  // namespace

std::vector<TomlSection> parse_toml(const std::string& text, const std::string& name) {
    const Value parsed = parse(text, name);
    const NamedLines file(text, name);
    std::vector<TomlSection> sections;
    for (const auto& [section_name, content] : entries_of(parsed)) {
        TomlSection& section = sections.emplace_back();
        section.name = section_name;
        section.is_table = content->is_table();
        if (!section.is_table) {
            section.where = position_of_key(file, section_name, *content);
            continue;
        }
        section.where = position_of_section(file, *content);
        for (const auto& [key, value] : entries_of(*content)) {
            section.settings.push_back(to_setting(key, *value, position_of_key(file, key, *value)));
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
