// SPDX-License-Identifier: Apache-2.0
//
// Serves a live page of the daemon's depth to browsers.
#include <exception>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "base/option_tree.h"
#include "base/version.h"
#include "bridges/web/options.h"
#include "bridges/web/server.h"

namespace {

using namespace disparityd::web;

constexpr const char* program = "disparity-web";

enum ExitStatus : int {
    exit_stopped = 0,  ///< SIGTERM or SIGINT ended it
    exit_failed = 1,   ///< the system refuses
    exit_user = 2,     ///< an argument is wrong
};

void print_error(std::string text) {
    for (char& character : text) {
        const auto code = static_cast<unsigned char>(character);
        character = code < 0x20 || code == 0x7f ? '?' : character;
    }
    std::cerr << program << ": error: " << text << std::endl;
}

int run(const Options& options) {
    Server server(options.settings());
    std::cout << server.url() << std::endl;
    server.run();
    return exit_stopped;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app(
        "Shows what a running disparityd sees on a page in the browser: images, distances, a cloud of points, its "
        "state. The daemon may come and go.",
        program);
    Options options;
    options.add_to(app);
    app.set_version_flag("--version", disparityd::base::version_line(program));
    disparityd::base::add_option_tree(app);
    app.footer(
        "Examples: disparity-web\n"
        "          disparity-web --name front --listen 127.0.0.1:8766 --allow-control\n"
        "Exit status: 0 SIGTERM or Ctrl-C ended it; 1 the system refuses; 2 an argument is wrong.");
    try {
        app.parse(argc, argv);
        return run(options);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ParseError& error) {
        print_error(std::string(error.what()) + "; see " + program + " --help");
        return exit_user;
    } catch (const std::invalid_argument& error) {
        print_error(std::string(error.what()) + "; see " + program + " --help");
        return exit_user;
    } catch (const std::exception& error) {
        print_error(error.what());
        return exit_failed;
    }
}
