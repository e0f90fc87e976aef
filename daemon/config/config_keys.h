// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/config/config.h"

namespace disparityd::daemon {

/// A value of a key, as a TOML file has it.
using ConfigValue =
    std::variant<std::string, std::int64_t, bool, std::vector<std::int64_t>, double, std::vector<std::string>>;

/// Returns the value in TOML syntax, for messages.
std::string to_text(const ConfigValue& value);

/// One key of the configuration: its name, its range and its field, which are defined here only.
struct ConfigKey {
    std::string_view section;
    std::string_view name;
    std::string allowed;  ///< for people: "2 .. 32", "true or false"
    ConfigValue example;  ///< of the right type
    /// Sets the field; false when the value is of another type or out of range.
    std::function<bool(Config&, const ConfigValue&)> set;
    std::function<ConfigValue(const Config&)> get;
};

const std::vector<ConfigKey>& config_keys();

/// Returns "section.name", as the command line writes a key.
std::string full_name(const ConfigKey& key);

}  // namespace disparityd::daemon
