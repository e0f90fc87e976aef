// SPDX-License-Identifier: Apache-2.0
#include "daemon/command_line.h"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace disparityd {
namespace {

constexpr const char* footer =
    "\nExamples:\n"
    "  disparityd                                     the configuration of this machine, or the built-in scene\n"
    "  disparityd --source recording.mkv --exit-at-end\n"
    "  disparityd --config my.toml --set match.disparities=128 --set rectify.width=640 --set rectify.height=360\n"
    "  disparityd --config my.toml --check\n"
    "\nEvery key is explained in disparityd.example.toml. SIGHUP loads the configuration again, SIGTERM stops.\n"
    "Exit status: 0 stopped as asked, 1 the system refused something, 2 the configuration or the input is wrong.";

/// The machine's configuration when there is one.
std::string default_config_path() {
    std::error_code error;
    return std::filesystem::exists(DISPARITYD_CONFIG_FILE, error) ? DISPARITYD_CONFIG_FILE : "";
}

}  // namespace

std::optional<CommandLine> read_command_line(int argc, const char* const* argv) {
    CLI::App app("Depth service for stereo cameras: reads frames, matches them, serves disparity and depth.",
                 "disparityd");
    app.footer(footer);
    app.set_version_flag("--version", std::string("disparityd ") + DISPARITYD_VERSION);
    CommandLine line;
    std::string source;
    std::string name;
    std::vector<std::string> settings;
    bool self_calibrate = false;
    bool no_self_calibration = false;
    app.add_option("--config", line.daemon.config_path,
                   std::string("Configuration file (default: ") + DISPARITYD_CONFIG_FILE + " if there is one)")
        ->type_name("FILE");
    app.add_option("--source", source, "Where frames come from, instead of [source] uri")->type_name("URI");
    app.add_option("--name", name, "Name of the shared memory, instead of [shared_memory] name")->type_name("NAME");
    app.add_option("--set", settings, "Any key of the configuration; may be given again and again")
        ->type_name("SECTION.KEY=VALUE")
        ->expected(1)
        ->take_all()
        ->allow_extra_args(false);
    app.add_flag("--self-calibrate", self_calibrate,
                 "Estimate corrections of the calibration from recordings too, instead of applying what they say");
    app.add_flag("--no-self-calibration", no_self_calibration, "Use the calibration as it is");
    app.add_flag("--check", line.check, "Say whether the configuration is valid, and exit with 0 or 2");
    app.add_flag("--exit-at-end", line.daemon.exit_at_end, "Stop when the source has ended");
    app.add_flag("--print-address", line.daemon.print_address,
                 "Print the addresses that are served, one per line, then \"ready\"");
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
    for (const std::string& setting : settings) {
        line.daemon.overrides.push_back(parse_override(setting));
    }
    if (app.count("--source") > 0) {
        line.daemon.overrides.push_back({"source", "uri", source, "--source " + source});
    }
    if (app.count("--name") > 0) {
        line.daemon.overrides.push_back({"shared_memory", "name", name, "--name " + name});
    }
    if (self_calibrate) {
        line.daemon.overrides.push_back({"self_calibration", "replays", "true", "--self-calibrate"});
    }
    if (no_self_calibration) {
        line.daemon.overrides.push_back({"self_calibration", "enabled", "false", "--no-self-calibration"});
    }
    return line;
}

}  // namespace disparityd
