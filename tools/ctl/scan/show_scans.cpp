// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <CLI/CLI.hpp>

#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/no_frame.h"
#include "tools/ctl/scan/live_screen.h"
#include "tools/ctl/scan/rate_limit.h"
#include "tools/ctl/scan/scan_feed.h"
#include "tools/ctl/scan/scan_view.h"

namespace disparityd::tools {
namespace {

using ScanClock = std::chrono::steady_clock;

struct ShowScansArguments {
    DaemonArguments daemon;
    std::optional<int> lines;
    std::optional<double> rate;
    RadarChoice radar;
    bool plot = false;
    bool line = false;
    bool json = false;
};

/// Notices when no scan comes, and asks why once a second.
class Silence {
public:
    void end() {
        last_scan_ = told_ = ScanClock::now();
        lost_ = false;
    }

    /// Returns whether it is time to say so: at once when the daemon was lost, else after a second.
    bool to_be_told(bool lost) {
        const auto now = ScanClock::now();
        const bool at_once = lost && !lost_;
        lost_ = lost;
        if (!at_once && now - told_ < std::chrono::seconds(1)) {
            return false;
        }
        told_ = now;
        return true;
    }

    double seconds() const { return std::chrono::duration<double>(ScanClock::now() - last_scan_).count(); }

private:
    ScanClock::time_point last_scan_ = ScanClock::now();
    ScanClock::time_point told_ = last_scan_;
    bool lost_ = false;
};

bool wants_plot(const ShowScansArguments& arguments) {
    return arguments.plot || (!arguments.line && !arguments.json && LiveScreen().in_place());
}

std::unique_ptr<ScanView> view_of(const ShowScansArguments& arguments) {
    if (wants_plot(arguments)) {
        return radar_scan_view(arguments.radar);
    }
    return arguments.json ? json_scan_view() : line_scan_view();
}

int show_scans(const ShowScansArguments& arguments) {
    ScanFeed feed(arguments.daemon);
    catch_interrupts();
    const auto view = view_of(arguments);
    constexpr double plots_per_second = 10;  // more cannot be read, and cost a slow terminal much
    RateLimit limit(arguments.rate || !wants_plot(arguments) ? arguments.rate : std::optional(plots_per_second));
    Silence silence;
    for (int lines = 0; (!arguments.lines || lines < *arguments.lines) && !interrupted();) {
        // Ctrl-C ends a wait after this time at most.
        constexpr std::chrono::milliseconds patience{100};
        if (!view->taken(patience)) {
            silence.end();  // it is not the daemon that is slow
            continue;
        }
        const ScanFeed::Got got = feed.next(patience);
        if (got == ScanFeed::Got::scan) {
            silence.end();
            if (limit.allows(ScanClock::now())) {
                view->show(feed.reading());
                ++lines;
            }
        } else if (silence.to_be_told(got == ScanFeed::Got::no_daemon)) {
            if (got == ScanFeed::Got::no_daemon) {
                view->show_none(feed.why(), silence.seconds());
            } else {
                view->hide(silence.seconds());
                view->show_none(why_no_frame(arguments.daemon), silence.seconds());
            }
            ++lines;
        }
    }
    return exit_done;
}

}  // namespace

void add_scan(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("scan", "Show the obstacle scan of a running daemon: a radar, lines or JSON.");
    const auto arguments = std::make_shared<ShowScansArguments>();
    arguments->daemon.add_to(command);
    add_integer(command, "--count", arguments->lines, 1, 1'000'000'000,
                "stop after this many plots or lines; default: Ctrl-C stops");
    add_real(command, "--rate", arguments->rate, 0.01, 1000,
             "show at most so many scans a second; default: 10 plots, or every scan");
    CLI::Option* const plot =
        command.add_flag("--plot", arguments->plot, "a radar plot for each scan; the default on a terminal");
    CLI::Option* const line =
        command.add_flag("--line", arguments->line, "a line for each scan; the default elsewhere")->excludes(plot);
    CLI::Option* const json = command.add_flag("--json", arguments->json, "a JSON object for each scan, one per line");
    json->excludes(plot)->excludes(line);
    command
        .add_flag("--ascii", arguments->radar.ascii, "draw with ASCII only; the default where the locale has no UTF-8")
        ->excludes(line)
        ->excludes(json);
    add_real(command, "--range", arguments->radar.range_m, 0.5, 65,
             "metres that the plot shows; default: as much as the scans need")
        ->excludes(line)
        ->excludes(json);
    command.footer(
        "The daemon makes scans where [scan] enabled = true. They come over shared memory, or over the socket when\n"
        "--socket is given. The plot shows the robot (at the bottom) from above: free is shaded, obstacles are "
        "blocks,\n"
        "blank is unknown, rings have their distance. While no scan comes, a plot or line each second says why; a\n"
        "daemon that was away is found again. Into a pipe a line is written when the last one was read: a slow\n"
        "program misses scans and reads no old ones. Colours are left out where NO_COLOR is set. Ctrl-C ends it, exit\n"
        "status 0; 1 when the daemon makes no scans.\n"
        "Examples: disparityctl scan\n"
        "          disparityctl scan --json | jq -c '[.age_ms, .nearest]'");
    command.callback([arguments, &action] { action = [arguments] { return show_scans(*arguments); }; });
}

}  // namespace disparityd::tools
