// SPDX-License-Identifier: Apache-2.0
#include "base/option_tree.h"

#include <algorithm>
#include <set>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace disparityd::base {
namespace {

using nlohmann::ordered_json;

/// Returns the names in an order that does not depend on where the options lie in memory.
std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
    std::vector<std::string> names;
    names.reserve(options.size());
    for (const CLI::Option* const option : options) {
        names.push_back(option->get_name());
    }
    std::sort(names.begin(), names.end());
    return names;
}

ordered_json option_json(const CLI::Option& option) {
    ordered_json names = ordered_json::array();
    if (option.get_positional()) {
        names.push_back(option.get_name(true));
    }
    for (const std::string& name : option.get_snames()) {
        names.push_back('-' + name);
    }
    for (const std::string& name : option.get_lnames()) {
        names.push_back("--" + name);
    }
    const bool takes_value = option.get_items_expected_max() > 0;
    const bool several = takes_value && (option.get_expected_max() > 1 ||
                                         option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll);
    return {{"names", std::move(names)},
            {"positional", option.get_positional()},
            {"value", takes_value ? option.get_type_name() : std::string()},
            {"several", several},
            {"required", option.get_required()},
            {"default", option.get_default_str()},
            {"group", option.get_group()},
            {"description", option.get_description()},
            {"needs", names_of(option.get_needs())},
            {"excludes", names_of(option.get_excludes())}};
}

ordered_json command_json(const CLI::App& app) {
    ordered_json options = ordered_json::array();
    for (const CLI::Option* const option : app.get_options()) {
        if (!option->get_group().empty()) {  // else hidden
            options.push_back(option_json(*option));
        }
    }
    ordered_json commands = ordered_json::array();
    for (const CLI::App* const command : app.get_subcommands({})) {
        commands.push_back(command_json(*command));
    }
    return {{"name", app.get_name()},
            {"description", app.get_description()},
            {"footer", app.get_footer()},
            {"options", std::move(options)},
            {"commands", std::move(commands)}};
}

}  // namespace

void add_option_tree(CLI::App& app, std::vector<TreeKey> keys) {
    const auto print = [&app, keys = std::move(keys)] {
        ordered_json tree = command_json(app);
        tree["keys"] = ordered_json::array();
        for (const TreeKey& key : keys) {
            tree["keys"].push_back({{"name", key.name}, {"allowed", key.allowed}});
        }
        throw CLI::CallForVersion(tree.dump(1), 0);
    };
    app.add_flag_callback("--option-tree", print)->configurable(false)->group("");
}

}  // namespace disparityd::base
