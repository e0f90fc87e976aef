// SPDX-License-Identifier: Apache-2.0
#pragma once

// Includes toml11, of which distributions have 3.7, 3.8 and 4.4. What 4 has under another name is here and nowhere
// else.

#include <cstddef>
#include <sstream>
#include <string>

#include <toml.hpp>

namespace disparityd::daemon {

/// A place in a text; both count from 1.
struct TomlPlace {
    std::size_t line = 0;
    std::size_t column = 0;
};

#if TOML11_VERSION_MAJOR >= 4

inline TomlPlace place_of(const toml::source_location& at) {
    return {at.first_line_number(), at.first_column_number()};
}

inline const std::string& string_of(const toml::value& value) {
    return value.as_string();
}

using TomlLibraryError = toml::syntax_error;

inline TomlPlace place_of(const TomlLibraryError& error) {
    return error.errors().empty() || error.errors().front().locations().empty()
               ? TomlPlace{1, 1}
               : place_of(error.errors().front().locations().front().first);
}

inline std::string title_of(const TomlLibraryError& error) {
    return error.errors().empty() ? "" : error.errors().front().title();
}

#else

inline TomlPlace place_of(const toml::source_location& at) {
    return {at.line(), at.column()};
}

inline const std::string& string_of(const toml::value& value) {
    return value.as_string().str;
}

using TomlLibraryError = toml::exception;

inline TomlPlace place_of(const TomlLibraryError& error) {
    return place_of(error.location());
}

inline std::string title_of(const TomlLibraryError& error) {
    const std::string text = error.what();
    return text.substr(0, text.find('\n'));
}

#endif

/// Parses a text. Throws TomlLibraryError where it is not TOML, another std::exception for some numbers.
inline toml::value parse_with_library(const std::string& text, const std::string& name) {
    std::istringstream stream(text);
    return toml::parse(stream, name);
}

}  // namespace disparityd::daemon
