// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace disparityd::base {

/// A key of a configuration, as the option tree has it.
struct TreeKey {
    std::string name;     ///< "section.key"
    std::string allowed;  ///< for people
};

/// Adds the hidden option --option-tree. It prints all options and sub-commands of the program as JSON, with the keys
/// of its configuration, and ends the program as --version does. tools/docs makes manual pages and shell completions of
/// it.
void add_option_tree(CLI::App& app, std::vector<TreeKey> keys = {});

}  // namespace disparityd::base
