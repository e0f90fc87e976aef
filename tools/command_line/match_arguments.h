// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/match_choice.h"

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::tools {

/// Every option of matching but the method, as the command line has them; what is not given keeps the tuned default
/// of the method.
class MatchArguments {
public:
    /// `disparities_default` completes the sentence in --help; `usual` is the preset where none is given.
    void add_to(CLI::App& app, const std::string& disparities_default, Preset usual = Preset::paper);

    std::optional<int> disparities() const { return given("disparities"); }
    int d_min() const { return given("d_min").value_or(0); }
    /// Returns what the command line has for a row of match_fields(), 0 or 1 for a switch.
    std::optional<int> given(std::string_view name) const;
    /// Whether the command line has any of them.
    bool any() const;

    /// Makes `usual` the preset that options() begin with where the command line has none.
    void set_usual(Preset usual) { usual_ = usual; }

    /// Options for a method; `disparities` candidates where --disparities is not given. Throws std::invalid_argument
    /// with one line when they do not fit together.
    MatchOptions options(Method method, int disparities) const;

    /// Throws std::invalid_argument with one line when an option is given that none of the methods uses.
    void check_used(const std::vector<Method>& methods) const;

private:
    MatchChoice choice() const;

    std::map<std::string_view, std::optional<int>> given_;
    Preset usual_ = Preset::paper;
    std::string preset_, cost_;
};

/// Throws std::invalid_argument for a word that is no method.
Method parse_method(const std::string& text);

/// For --method: when which method serves (docs/operations.md has the figures).
std::string method_help();

/// For --backend: the names that there are, with their descriptions.
std::string backend_help();

}  // namespace disparityd::tools
