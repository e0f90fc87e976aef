// SPDX-License-Identifier: Apache-2.0
//
// Measures how long a frame takes from publishing until a client has it.
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"
#include "tools/handover/reader_process.h"

namespace disparityd::handover {
namespace {

struct Arguments {
    std::string name = "default";
    std::string address;
    std::vector<int> readers{1, 16};
    std::optional<double> seconds;
    bool markdown = false;
};

const char* title_of(Way way) {
    switch (way) {
        case Way::copy: return "shared memory, copied";
        case Way::borrow: return "shared memory, borrowed";
        case Way::socket: break;
    }
    return "socket";
}

std::string milliseconds_at(const std::vector<std::int64_t>& sorted, double share) {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1));
    return tools::fixed(static_cast<double>(sorted[rank]) / 1e6, 3);
}

std::vector<std::string> measure(const Arguments& arguments, Way way, int readers) {
    std::vector<std::unique_ptr<ReaderProcess>> processes;
    for (int i = 0; i < readers; ++i) {
        processes.push_back(std::make_unique<ReaderProcess>(
            ReaderOptions{way, arguments.name, arguments.address, arguments.seconds.value_or(10)}));
    }
    Seen all;
    for (const auto& process : processes) {
        const Seen seen = process->wait();
        all.handover_ns.insert(all.handover_ns.end(), seen.handover_ns.begin(), seen.handover_ns.end());
        all.missed += seen.missed;
        all.torn += seen.torn;
        all.untimed += seen.untimed;
    }
    if (all.handover_ns.empty()) {
        throw std::runtime_error("no frame came in " + tools::fixed(arguments.seconds.value_or(10), 1) +
                                 " s: is the source running? disparityctl status says it");
    }
    std::sort(all.handover_ns.begin(), all.handover_ns.end());
    return {title_of(way),
            std::to_string(readers),
            std::to_string(all.handover_ns.size()),
            milliseconds_at(all.handover_ns, 0.5),
            milliseconds_at(all.handover_ns, 0.99),
            milliseconds_at(all.handover_ns, 1),
            std::to_string(all.untimed),
            std::to_string(all.missed),
            way == Way::borrow ? std::to_string(all.torn) : "-"};
}

int print_handover(const Arguments& arguments) {
    tools::Table table(
        {"way", "readers", "frames", "p50 ms", "p99 ms", "max ms", "not timed", "missed", "written over"});
    std::vector<Way> ways{Way::copy, Way::borrow};
    if (!arguments.address.empty()) {
        ways.push_back(Way::socket);
    }
    for (const Way way : ways) {
        for (const int readers : arguments.readers) {
            table.add(measure(arguments, way, readers));
        }
    }
    arguments.markdown ? table.print_markdown(std::cout) : table.print(std::cout);
    return tools::exit_done;
}

}  // namespace
}  // namespace disparityd::handover

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App app("The time from the moment when a running daemon publishes a frame until a client's read returns.",
                 "disparity-handover");
    app.footer(
        "Example: disparityd --source scene:vga@100 & disparity-handover --socket unix:/run/disparityd/socket\n"
        "Each reader is a process of its own. It reads all products and adds up the depth. The daemon needs a live\n"
        "source (a camera, or a scene): frames of a recording have the times of their day.\n"
        "not timed: frames of the socket of which the shared memory did not say when they were published.\n"
        "missed: frames that the readers did not see. written over: borrowed frames that the daemon overwrote before\n"
        "their depth was added up.\n"
        "Exit status: 0 done; 1 the system or the daemon refused; 2 arguments must be changed.");
    handover::Arguments arguments;
    app.add_option("--name", arguments.name, "of the shared memory; default \"default\"")->type_name("NAME");
    app.add_option("--socket", arguments.address, "measures this socket, too: tcp:HOST:PORT or unix:PATH")
        ->type_name("ADDRESS");
    app.add_option("--readers", arguments.readers, "numbers of readers; default 1,16")
        ->delimiter(',')
        ->check(CLI::Range(1, 256))
        ->type_name("N,..");
    tools::add_real(app, "--seconds", arguments.seconds, 0.1, 3600, "for each line of the table; default 10");
    app.add_flag("--markdown", arguments.markdown, "the table in Markdown");
    return tools::run_program(app, argc, argv, [&] { return handover::print_handover(arguments); });
}
