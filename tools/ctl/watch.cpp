// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "clients/cpp/disparity_client.hpp"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"

namespace disparityd::tools {
namespace {

/// Collects the latencies and losses of the frames of one interval.
class LatencyWindow {
public:
    void add(const disparity::Frame& frame);

    struct Summary {
        std::uint64_t frames = 0;
        double p50_ms = 0;  ///< 0 when there were no frames
        double p99_ms = 0;
        std::uint64_t dropped = 0;  ///< lost before the daemon published
        std::uint64_t skipped = 0;  ///< published, but not read here
    };
    /// Returns the summary of all frames added since the call before.
    Summary take();

private:
    bool first_ = true;
    std::vector<std::int64_t> ages_ns_;
    std::uint64_t dropped_ = 0;
    std::uint64_t skipped_ = 0;
};

/// Returns the smallest value that at least `percent` of all values do not exceed.
double percentile_ms(const std::vector<std::int64_t>& sorted_ns, std::size_t percent) {
    if (sorted_ns.empty()) {
        return 0;
    }
    const std::size_t rank = (sorted_ns.size() * percent + 99) / 100;
    return static_cast<double>(sorted_ns[std::max<std::size_t>(rank, 1) - 1]) / 1e6;
}

void LatencyWindow::add(const disparity::Frame& frame) {
    ages_ns_.push_back(frame.age_ns);
    dropped_ += first_ ? 0 : frame.dropped_before;  // those before the first one were not for this program
    first_ = false;
    skipped_ += frame.skipped;
}

LatencyWindow::Summary LatencyWindow::take() {
    std::sort(ages_ns_.begin(), ages_ns_.end());
    const Summary summary{ages_ns_.size(), percentile_ms(ages_ns_, 50), percentile_ms(ages_ns_, 99), dropped_,
                          skipped_};
    ages_ns_.clear();
    dropped_ = 0;
    skipped_ = 0;
    return summary;
}

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
