// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/config.h"

namespace disparityd {

/// A value as it stands in the file.
using ConfigValue = std::variant<std::string, std::int64_t, bool, std::vector<std::int64_t>>;

/// The value as TOML has it, for messages.
std::string to_text(const ConfigValue& value);

/// One key: the only place that knows its name, its range and its field.
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

}  // namespace disparityd
