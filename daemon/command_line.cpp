// SPDX-License-Identifier: Apache-2.0
#include "daemon/command_line.h"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "base/option_tree.h"
#include "base/version.h"
#include "daemon/config/config_keys.h"

namespace disparityd::daemon {
namespace {

constexpr const char* footer =
    "\nExamples:\n"
    "  disparityd                                     the configuration of this machine, or the first camera\n"
    "  disparityd --source recording.mkv --exit-at-end\n"
    "  disparityd --config my.toml --set match.disparities=128 --set rectify.width=640 --set rectify.height=360\n"
    "  disparityd --config my.toml --check\n"
    "\nEvery key is explained in disparityd.example.toml. SIGHUP loads the configuration again, SIGTERM stops.\n"
    "Exit status: 0 stopped as asked, 1 the system refused something, 2 the configuration or the input is wrong.";

/// Returns the path of the machine's configuration; empty when there is none.
std::string default_config_path() {
    std::error_code error;
    return std::filesystem::exists(DISPARITYD_CONFIG_FILE, error) ? DISPARITYD_CONFIG_FILE : "";
}

/// Options that override keys of the configuration.
struct Overrides {
    std::string source;
    std::string name;
    std::vector<std::string> settings;
    bool self_calibrate = false;
    bool no_self_calibration = false;
};

std::vector<base::TreeKey> tree_keys() {
    std::vector<base::TreeKey> keys;
    keys.reserve(config_keys().size());
    for (const ConfigKey& key : config_keys()) {
        keys.push_back({full_name(key), key.allowed});
    }
    return keys;
}

void add_options(CLI::App& app, CommandLine& line, Overrides& given) {
    app.footer(footer);
    app.set_version_flag("--version", base::version_line("disparityd"));
    base::add_option_tree(app, tree_keys());
    app.add_option("--config", line.daemon.config_path,
                   std::string("Configuration file (default: ") + DISPARITYD_CONFIG_FILE + " if there is one)")
        ->type_name("FILE");
    app.add_option("--source", given.source, "Where frames come from, instead of [source] uri")->type_name("URI");
    app.add_option("--name", given.name, "Name of the shared memory, instead of [shared_memory] name")
        ->type_name("NAME");
    app.add_option("--set", given.settings, "Set any key of the configuration; may be repeated")
        ->type_name("SECTION.KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
    app.add_flag("--self-calibrate", given.self_calibrate,
                 "Estimate corrections of the calibration from recordings too, instead of applying those they hold");
    app.add_flag("--no-self-calibration", given.no_self_calibration, "Use the calibration without corrections");
    app.add_flag("--check", line.check, "Check the configuration on this machine and exit; nothing is served");
    app.add_flag("--exit-at-end", line.daemon.exit_at_end, "Stop when the source has ended");
    app.add_flag("--print-address", line.daemon.print_address,
                 "Print the addresses that are served, one per line, then \"ready\" (frames can be read)");
}

/// Returns the overrides in order: --set first, so that an option of its own wins.
std::vector<Override> in_order(const CLI::App& app, const Overrides& given) {
    std::vector<Override> overrides;
    for (const std::string& setting : given.settings) {
        overrides.push_back(parse_override(setting));
    }
    if (app.count("--source") > 0) {
        overrides.push_back({"source", "uri", given.source, "--source " + given.source});
    }
    if (app.count("--name") > 0) {
        overrides.push_back({"shared_memory", "name", given.name, "--name " + given.name});
    }
    if (given.self_calibrate) {
        overrides.push_back({"self_calibration", "replays", "true", "--self-calibrate"});
    }
    if (given.no_self_calibration) {
        overrides.push_back({"self_calibration", "enabled", "false", "--no-self-calibration"});
    }
    return overrides;
}

}  // namespace

std::optional<CommandLine> read_command_line(int argc, const char* const* argv) {
    CLI::App app("Depth service for stereo cameras: reads frames, matches them, serves disparity and depth.",
                 "disparityd");
    CommandLine line;
    Overrides given;
    add_options(app, line, given);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& answered) {
        app.exit(answered);
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw std::invalid_argument(std::string("command line: ") + error.what() + "; disparityd --help explains it");
    }
    if (app.count("--config") == 0) {
        line.daemon.config_path = default_config_path();
    } else if (line.daemon.config_path.empty()) {
        throw std::invalid_argument("--config: found an empty name, allowed: the path of a configuration file");
    }
    line.daemon.overrides = in_order(app, given);
    return line;
}

}  // namespace disparityd::daemon
