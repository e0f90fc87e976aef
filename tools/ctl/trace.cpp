// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "base/words.h"
#include "base/write_failure.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/trace_json.h"

namespace disparityd::tools {
namespace {

struct TraceArguments {
    DaemonArguments daemon;
    std::string file;
    std::optional<double> seconds;
    bool force = false;
};

constexpr double usual_seconds = 3;

int trace(const TraceArguments& arguments) {
    check_output(arguments.file, arguments.force);
    disparity::Client client = connect(arguments.daemon);
    const v1::Trace trace = trace_daemon(client.socket(), arguments.seconds.value_or(usual_seconds));
    std::ofstream file(arguments.file, std::ios::binary | std::ios::trunc);
    const std::uint64_t events = file ? write_trace_json(file, trace) : 0;
    file.close();
    if (!file) {
        base::refuse_to_write(arguments.file, errno);
    }
    constexpr double ns_of_s = 1e9;
    std::cout << arguments.file << ": " << base::counted(events, "event") << " in "
              << fixed(static_cast<double>(trace.duration_ns()) / ns_of_s, 1) << " s; open it in ui.perfetto.dev\n";
    if (const std::uint64_t dropped = dropped_events(trace); dropped > 0) {
        print_note("the daemon had no room for " + base::counted(dropped, "event") +
                   " more: threads that do much have none at the end; take fewer --seconds");
    }
    return exit_done;
}

}  // namespace

void add_trace(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand(
        "trace", "Record for some seconds what the threads of a running daemon do, and what frames wait for.");
    const auto arguments = std::make_shared<TraceArguments>();
    command.add_option("-o,--output", arguments->file, "the trace to write, such as trace.json")
        ->type_name("FILE")
        ->required();
    add_real(command, "--seconds", arguments->seconds, 0.1, 10, "how long; default: 3");
    command.add_flag("--force", arguments->force, "replace FILE when it exists");
    arguments->daemon.add_to(command);
    command.footer(
        "FILE has Chrome's trace event format (JSON), which ui.perfetto.dev and chrome://tracing show: a row for each\n"
        "thread with the stages and steps of each frame and what the thread waits for, a row for each queue, and for\n"
        "each worker whom it helps. Arrows follow a frame. Frames are the same, and take less than 1 % longer\n"
        "meanwhile.\n"
        "Example: disparityctl trace -o trace.json --seconds 2");
    command.callback([arguments, &action] { action = [arguments] { return trace(*arguments); }; });
}

}  // namespace disparityd::tools
