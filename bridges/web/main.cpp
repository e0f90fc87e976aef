// SPDX-License-Identifier: Apache-2.0
//
// Serves a live page of the daemon's depth to browsers.
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>

#include "base/descriptor_limit.h"
#include "base/freed_memory.h"
#include "base/program_end.h"
#include "bridges/program/program.h"
#include "bridges/web/options.h"
#include "bridges/web/server.h"

int main(int argc, char** argv) {
    CLI::App app(
        "Shows what a running disparityd sees on a page in the browser: images, distances, a cloud of points, its "
        "state. The daemon may come and go.",
        "disparity-web");
    disparityd::web::Options options;
    options.add_to(app);
    app.footer(
        "Examples: disparity-web\n"
        "          disparity-web --name front --listen 127.0.0.1:8766 --allow-control\n"
        "          disparity-web --all\n"
        "Exit status: 0 SIGTERM or Ctrl-C ended it; 1 the system refuses; 2 an argument is wrong.");
    const int code = disparityd::bridges::run_program(app, argc, argv, [&app, &options] {
        auto settings = options.settings();
        const std::string fewer =
            disparityd::web::fit_to_descriptors(settings, disparityd::base::raise_descriptor_limit());
        if (!fewer.empty()) {
            disparityd::bridges::print_line(app.get_name(), "note", fewer);
        }
        disparityd::base::set_up_freed_memory();
        disparityd::web::Server server(settings);
        std::cout << server.url() << std::endl;
        server.run();
    });
    return disparityd::base::end_program(code);
}
