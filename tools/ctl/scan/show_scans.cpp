// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <deque>
#include <iostream>
#include <stdexcept>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

#include "proto/disparity.pb.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/scan/rate_limit.h"
#include "tools/ctl/scan/scan_text.h"
#include "tools/ctl/scan/scan_view.h"

namespace disparityd::tools {
namespace {

/// Reads the obstacle scans of a running daemon, and finds it again when it was away. One thread uses it.
class ScanFeed {
public:
    enum class Got {
        scan,      ///< reading() has it
        nothing,   ///< nothing new came in time; the daemon lives
        no_daemon  ///< why() says why; later calls look for it again
    };

    /// Throws as connect() does.
    explicit ScanFeed(const DaemonArguments& daemon);

    /// Waits for the next scan. Throws std::runtime_error with one line when the daemon makes no scans. Takes longer
    /// than the timeout where a daemon is being looked for and does not answer: up to 5 s.
    Got next(std::chrono::milliseconds timeout);

    const ScanReading& reading() const { return reading_; }
    const std::string& why() const { return why_; }

private:
    using Clock = std::chrono::steady_clock;

    bool may_make_scans();
    Got lose(const std::string& why);
    Got take();

    disparity::Client client_;
    bool there_ = false;  ///< a frame or silence of the daemon came since it was lost
    disparity::Frame frame_;
    ScanReading reading_;
    std::string why_;
    std::deque<Clock::time_point> arrivals_;  ///< of the last seconds, for the rate
};

constexpr std::chrono::seconds rate_window{2};

[[noreturn]] void refuse_daemon_without_scans() {
    throw std::runtime_error(
        "the daemon makes no obstacle scans: set [scan] enabled = true in its configuration and reload it");
}

ScanFeed::ScanFeed(const DaemonArguments& daemon) : client_(connect(daemon, {disparity::Product::scan})) {}

/// Returns false when a daemon that answers says that it makes none.
bool ScanFeed::may_make_scans() {
    try {
        v1::Welcome welcome;
        if (!welcome.ParseFromString(client_.socket().welcome()) || welcome.products().empty()) {
            return true;  // its source is being prepared
        }
        return std::find(welcome.products().begin(), welcome.products().end(), v1::SCAN) != welcome.products().end();
    } catch (const std::runtime_error&) {
        return true;
    }
}

/// Keeps why it was lost first: that says more than why it is not found again.
ScanFeed::Got ScanFeed::lose(const std::string& why) {
    if (std::exchange(there_, false) || why_.empty()) {
        why_ = why;
    }
    arrivals_.clear();
    return Got::no_daemon;
}

ScanFeed::Got ScanFeed::next(std::chrono::milliseconds timeout) {
    disparity::ReadResult result{};
    try {
        result = client_.read(frame_, timeout);
    } catch (const std::runtime_error& error) {
        if (!may_make_scans()) {
            refuse_daemon_without_scans();
        }
        return lose(error.what());
    }
    if (result == disparity::ReadResult::gone) {
        return lose(client_.unanswered() ? "the daemon does not answer; waiting for it"
                                         : "the daemon has stopped; waiting for it");
    }
    const bool came = !std::exchange(there_, true);
    if (result == disparity::ReadResult::timeout) {
        return Got::nothing;
    }
    // Shared memory still holds the last frame from before, which may be hours old.
    return came && client_.where().starts_with("shared memory") ? Got::nothing : take();
}

ScanFeed::Got ScanFeed::take() {
    auto scan = frame_.scan();
    if (!scan) {
        refuse_daemon_without_scans();
    }
    const auto now = Clock::now();
    arrivals_.push_back(now);
    while (now - arrivals_.front() > rate_window) {
        arrivals_.pop_front();
    }
    reading_.frame = frame_;
    reading_.scan = *std::move(scan);
    reading_.age_ns = frame_.age_ns;
    reading_.rate.reset();
    // The first ones may have waited, and come at once.
    if (const std::chrono::duration<double> span = now - arrivals_.front(); span > rate_window / 2) {
        reading_.rate = static_cast<double>(arrivals_.size() - 1) / span.count();
    }
    return Got::scan;
}

using ScanClock = std::chrono::steady_clock;

struct ShowScansArguments {
    DaemonArguments daemon;
    std::optional<int> lines;
    std::optional<double> rate;
    RadarChoice radar;
    bool plot = false;
    bool line = false;
    bool json = false;
    bool mounting = false;
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

/// Waits for scans that know the mounting, and prints it as the configuration has it.
int show_mounting(const ShowScansArguments& arguments) {
    constexpr std::chrono::seconds patience{30};
    ScanFeed feed(arguments.daemon);
    catch_interrupts();
    const auto begin = ScanClock::now();
    while (ScanClock::now() - begin < patience && !interrupted()) {
        if (feed.next(std::chrono::milliseconds(100)) != ScanFeed::Got::scan) {
            continue;
        }
        if (const auto& mounting = feed.reading().scan.mounting) {
            std::cout << "[scan]\ncamera_height_m = " << fixed(mounting->height_m, 2)
                      << "\npitch_deg = " << fixed(mounting->pitch_deg, 1)
                      << "\nroll_deg = " << fixed(mounting->roll_deg, 1) << std::endl;
            return exit_done;
        }
    }
    throw std::runtime_error(interrupted() ? "stopped before a mounting was found"
                                           : "no mounting was found in 30 s: the camera must see 15 % of its picture "
                                             "as a floor with texture, which no "
                                             "more than 6 % lie below, for 80 frames without a change");
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
    command
        .add_flag("--mounting", arguments->mounting,
                  "print the mounting that the floor in view shows, as lines of the configuration")
        ->excludes(plot)
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
        "          disparityctl scan --mounting\n"
        "          disparityctl scan --json | jq -c '[.age_ms, .nearest]'");
    command.callback([arguments, &action] {
        action = [arguments] { return arguments->mounting ? show_mounting(*arguments) : show_scans(*arguments); };
    });
}

}  // namespace disparityd::tools
