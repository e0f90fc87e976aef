// SPDX-License-Identifier: Apache-2.0
//
// Measures how long a frame takes from publishing until a client has it.
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "clients/command_line/daemon_arguments.h"
#include "lab/handover/reader_process.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/table.h"

namespace disparityd::handover {
namespace {

struct Arguments {
    std::string name = "default";
    std::string address;
    std::vector<int> readers{1, 16};
    std::optional<double> seconds;
    bool markdown = false;
    std::vector<double> work;
    std::vector<std::string> products{"scan"};
    clients::ConnectArguments connect;
};

const char* title_of(Way way) {
    switch (way) {
        case Way::copy: return "shared memory, copied";
        case Way::borrow: return "shared memory, borrowed";
        case Way::socket:
        case Way::work: break;
    }
    return "socket";
}

/// Sorted times, in ms.
std::string milliseconds_at(const std::vector<std::int64_t>& sorted, double share) {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1));
    return tools::fixed(static_cast<double>(sorted[rank]) / 1e6, 3);
}

std::string no_frame(const Arguments& arguments) {
    return "no frame came in " + tools::fixed(arguments.seconds.value_or(10), 1) +
           " s: is the source running? disparityctl status says it";
}

std::vector<std::string> measure(const Arguments& arguments, Way way, int readers) {
    std::vector<std::unique_ptr<ReaderProcess>> processes;
    for (int i = 0; i < readers; ++i) {
        ReaderOptions options;
        options.way = way;
        options.name = arguments.name;
        options.address = arguments.address;
        options.seconds = arguments.seconds.value_or(10);
        processes.push_back(std::make_unique<ReaderProcess>(options));
    }
    Seen all;
    for (const auto& process : processes) {
        const Seen seen = process->wait();
        all.handover_ns.insert(all.handover_ns.end(), seen.handover_ns.begin(), seen.handover_ns.end());
        all.skipped += seen.skipped;
        all.torn += seen.torn;
        all.untimed += seen.untimed;
    }
    if (all.handover_ns.empty()) {
        throw std::runtime_error(no_frame(arguments));
    }
    std::sort(all.handover_ns.begin(), all.handover_ns.end());
    return {title_of(way),
            std::to_string(readers),
            std::to_string(all.handover_ns.size()),
            milliseconds_at(all.handover_ns, 0.5),
            milliseconds_at(all.handover_ns, 0.99),
            milliseconds_at(all.handover_ns, 1),
            std::to_string(all.untimed),
            std::to_string(all.skipped),
            way == Way::borrow ? std::to_string(all.torn) : "-"};
}

int print_handover(const Arguments& arguments) {
    tools::Table table(
        {"way", "readers", "frames", "p50 ms", "p99 ms", "max ms", "not timed", "skipped", "written over"});
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

disparity::Product product_of(const std::string& name) {
    const std::pair<const char*, disparity::Product> known[] = {{"scan", disparity::Product::scan},
                                                                {"disparity", disparity::Product::disparity},
                                                                {"depth", disparity::Product::depth},
                                                                {"left", disparity::Product::left}};
    for (const auto& [its_name, product] : known) {
        if (name == its_name) {
            return product;
        }
    }
    throw std::invalid_argument("--products: found " + name + ", allowed: scan, disparity, depth, left");
}

/// All readers run at once.
int print_ages(const Arguments& arguments) {
    if (arguments.address.empty()) {
        throw std::invalid_argument("--work needs --socket");
    }
    arguments.connect.check(arguments.address);
    ReaderOptions options;
    options.way = Way::work;
    options.address = arguments.address;
    options.seconds = arguments.seconds.value_or(10);
    options.connect = arguments.connect.options;
    options.products.clear();
    for (const std::string& name : arguments.products) {
        options.products.push_back(product_of(name));
    }
    std::vector<std::unique_ptr<ReaderProcess>> processes;
    for (const double work : arguments.work) {
        options.work_s = work;
        processes.push_back(std::make_unique<ReaderProcess>(options));
    }
    tools::Table table(
        {"work s", "frames/s", "skipped", "age p50 ms", "p99", "max", "told less true: min ms", "p50", "max"});
    for (std::size_t i = 0; i < processes.size(); ++i) {
        Seen seen = processes[i]->wait();
        if (seen.age_ns.empty()) {
            throw std::runtime_error(no_frame(arguments));
        }
        std::sort(seen.age_ns.begin(), seen.age_ns.end());
        std::sort(seen.told_less_ns.begin(), seen.told_less_ns.end());
        table.add({tools::fixed(arguments.work[i], 2),
                   tools::fixed(static_cast<double>(seen.age_ns.size()) / options.seconds, 1),
                   std::to_string(seen.skipped), milliseconds_at(seen.age_ns, 0.5), milliseconds_at(seen.age_ns, 0.99),
                   milliseconds_at(seen.age_ns, 1), milliseconds_at(seen.told_less_ns, 0),
                   milliseconds_at(seen.told_less_ns, 0.5), milliseconds_at(seen.told_less_ns, 1)});
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
        "skipped: frames that the readers did not see. written over: borrowed frames that the daemon overwrote before\n"
        "their depth was added up. told less true: the age that the library tells, less the true one; only on the\n"
        "daemon's own machine.\n"
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
    app.add_option("--work", arguments.work,
                   "instead of the above: readers of the socket that work so many seconds on each frame, all at once, "
                   "and how old the frames are that they are given")
        ->delimiter(',')
        ->check(CLI::Range(0.0, 60.0))
        ->type_name("S,..");
    app.add_option("--products", arguments.products, "for --work: scan, disparity, depth, left; default scan")
        ->delimiter(',')
        ->type_name("NAME,..");
    arguments.connect.add_to(app);
    return tools::run_program(app, argc, argv, [&] {
        return arguments.work.empty() ? handover::print_handover(arguments) : handover::print_ages(arguments);
    });
}
