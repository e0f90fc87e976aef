// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/latency_window.h"
#include "tools/ctl/no_frame.h"

namespace disparityd::tools {
namespace {

using std::chrono::steady_clock;

struct WatchArguments {
    DaemonArguments daemon;
    std::optional<int> lines;
    bool json = false;
};

/// `why`: the reason when there was no frame.
void print_line(const LatencyWindow::Summary& seen, double seconds, double since_start, const std::string& why,
                bool json) {
    const double rate = static_cast<double>(seen.frames) / seconds;
    if (json) {
        nlohmann::ordered_json line{{"seconds", since_start},    {"frames", seen.frames},
                                    {"frames_per_second", rate}, {"latency_p50_ms", nullptr},
                                    {"latency_p99_ms", nullptr}, {"dropped", seen.dropped},
                                    {"skipped", seen.skipped}};
        if (seen.frames > 0) {
            line["latency_p50_ms"] = seen.p50_ms;
            line["latency_p99_ms"] = seen.p99_ms;
        } else {
            line["why"] = why;
        }
        std::cout << line.dump() << std::endl;
        return;
    }
    char text[160];
    if (seen.frames > 0) {
        std::snprintf(text, sizeof text, "%6.0f s %9.1f %13.1f %10.1f %9llu %8llu", since_start, rate, seen.p50_ms,
                      seen.p99_ms, static_cast<unsigned long long>(seen.dropped),
                      static_cast<unsigned long long>(seen.skipped));
    } else {
        std::snprintf(text, sizeof text, "%6.0f s %9.1f %13s %10s %9s %8s  no frame: ", since_start, 0.0, "-", "-", "-",
                      "-");
    }
    std::cout << text << why << std::endl;
}

steady_clock::time_point born(const disparity::Frame& frame) {
    return steady_clock::now() - std::chrono::nanoseconds(frame.age_ns);
}

/// Returns how old the newest frame is, for the end of a line.
std::string age_of(const std::optional<steady_clock::time_point>& newest) {
    return newest ? "; the newest frame is " + seconds_text(steady_clock::now() - *newest) + " old" : std::string();
}

int watch(const WatchArguments& arguments) {
    disparity::Client client = connect(arguments.daemon, {disparity::Product::disparity});
    catch_interrupts();
    if (!arguments.json) {
        std::cout << "    time  frames/s  latency: p50    p99 ms   dropped  skipped   (" << client.where() << ")"
                  << std::endl;
    }
    disparity::Frame frame;
    // Shared memory still holds the last frame from before; it may be hours old.
    std::optional<steady_clock::time_point> newest;
    if (client.read(frame, std::chrono::milliseconds(0)) == disparity::ReadResult::frame) {
        newest = born(frame);
    }
    LatencyWindow window;
    const auto start = steady_clock::now();
    auto last = start;
    for (int lines = 0; (!arguments.lines || lines < *arguments.lines) && !interrupted();) {
        // Ctrl-C ends the wait after this time at most.
        constexpr std::chrono::milliseconds patience{100};
        const auto next = last + std::chrono::seconds(1);
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - steady_clock::now());
        switch (client.read(frame, std::clamp(left, std::chrono::milliseconds(0), patience))) {
            case disparity::ReadResult::frame:
                window.add(frame);
                newest = born(frame);
                break;
            case disparity::ReadResult::timeout: break;
            case disparity::ReadResult::gone:
                if (!client.unanswered()) {
                    throw std::runtime_error("the daemon has stopped");
                }
                break;  // it may answer again
        }
        const auto now = steady_clock::now();
        if (now >= next) {
            const LatencyWindow::Summary seen = window.take();
            print_line(seen, std::chrono::duration<double>(now - last).count(),
                       std::chrono::duration<double>(now - start).count(),
                       seen.frames > 0 ? "" : why_no_frame(arguments.daemon) + age_of(newest), arguments.json);
            if (!std::cout) {
                throw std::runtime_error("standard output cannot be written");
            }
            last = now;
            ++lines;
        }
    }
    return exit_done;
}

}  // namespace

void add_watch(CLI::App& program, Action& action) {
    CLI::App& command = *program.add_subcommand("watch", "Show frame rate, latency and losses, one line per second.");
    const auto arguments = std::make_shared<WatchArguments>();
    arguments->daemon.add_to(command);
    add_integer(command, "--count,--seconds", arguments->lines, 1, 1'000'000'000,
                "stop after this many lines; default: Ctrl-C stops");
    command.add_flag("--json", arguments->json, "one JSON object per line");
    command.footer(
        "Frames come over shared memory, or over the socket when --socket is given. Latency is the age of a frame\n"
        "when it arrives here, capture to copy, the network included. dropped: before the daemon published;\n"
        "skipped: published, but not read here. Ctrl-C ends it, exit status 0.\n"
        "Example: disparityctl watch --count 10");
    command.callback([arguments, &action] { action = [arguments] { return watch(*arguments); }; });
}

}  // namespace disparityd::tools
