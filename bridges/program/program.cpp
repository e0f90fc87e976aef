// SPDX-License-Identifier: Apache-2.0
#include "bridges/program/program.h"

#include <exception>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "base/message_text.h"
#include "base/option_tree.h"
#include "base/version.h"

namespace disparityd::bridges {

int run_program(CLI::App& app, int argc, char** argv, const std::function<void()>& serve) {
    const std::string program = app.get_name();
    const auto refuse = [&program](const std::exception& error) {
        print_line(program, "error", std::string(error.what()) + "; see " + program + " --help");
        return exit_user;
    };
    app.set_version_flag("--version", base::version_line(program));
    base::add_option_tree(app);
    try {
        app.parse(argc, argv);
        serve();
        return exit_stopped;
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        return refuse(error);
    } catch (const std::invalid_argument& error) {
        return refuse(error);
    } catch (const std::exception& error) {
        print_line(program, "error", error.what());
        return exit_failed;
    }
}

void print_line(const std::string& program, const char* kind, const std::string& text) {
    std::cerr << program << ": " << kind << ": " << base::printable_line(text) << std::endl;
}

}  // namespace disparityd::bridges
