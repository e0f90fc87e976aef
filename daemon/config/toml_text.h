// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config_keys.h"

namespace disparityd::daemon {

/// A key = value of a TOML text.
struct TomlSetting {
    std::string key;
    std::optional<ConfigValue> value;  ///< empty: of a type that no key of disparityd has
    std::string found;                 ///< the value for messages: in TOML syntax, or its type
    std::string where;                 ///< "NAME:LINE:COLUMN" of the key
};

/// A [section] and what is in it, in the order of the keys' names.
struct TomlSection {
    std::string name;
    bool is_table = true;  ///< false: a key that stands outside of a section
    std::string where;     ///< "NAME:LINE:COLUMN"
    std::vector<TomlSetting> settings;
};

/// The longest text that is parsed; the example with every key is a sixth of it. toml11 takes time with the square of
/// the elements of an array: seconds for this much, minutes for a megabyte.
inline constexpr std::size_t longest_toml = 64 * 1024;

/// Parses a text from outside: any bytes. Returns its sections in the order of their names. Throws
/// std::invalid_argument "NAME:LINE:COLUMN: this is not TOML: ..." and where it is too long or nested too deeply
/// (toml_depth.h). The library behind it is toml11 (toml_library.h); nothing of it is seen outside.
std::vector<TomlSection> parse_toml(const std::string& text, const std::string& name);

/// Parses a value by itself, such as 128 or [1, 2]; empty when the text is not one value.
std::optional<TomlSetting> parse_toml_value(const std::string& text, const std::string& name);

}  // namespace disparityd::daemon
