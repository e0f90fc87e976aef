// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace disparityd::tools {

/// An option that takes a whole number from `least` to `most`; the refusal says what was found and what is allowed.
CLI::Option* add_integer(CLI::App& app, const std::string& name, std::optional<int>& value, int least, int most,
                         const std::string& description);

/// An option that takes a whole number that `allows` lets pass; `allowed` says in the refusal which these are.
CLI::Option* add_integer(CLI::App& app, const std::string& name, std::optional<int>& value,
                         const std::function<bool(int)>& allows, const std::string& allowed,
                         const std::string& description);

/// An option that takes a number from `least` to `most`, with a decimal point whatever the locale.
CLI::Option* add_real(CLI::App& app, const std::string& name, std::optional<double>& value, double least, double most,
                      const std::string& description);

/// An option that takes one word of a list.
CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& value,
                        std::initializer_list<const char*> allowed, const std::string& description);

/// A pair of flags, --name (1) and --no-name (0).
CLI::Option* add_switch(CLI::App& app, const std::string& name, std::optional<int>& value,
                        const std::string& description);

}  // namespace disparityd::tools
