// SPDX-License-Identifier: Apache-2.0
//
// Measures how long it takes until a client is shown a pole that was not there before.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include "clients/cpp/disparity_client.hpp"
#include "lab/handover/reader_process.h"
#include "lab/reaction/daemon_process.h"
#include "lab/reaction/pole_recording.h"
#include "lab/reaction/reaction_times.h"
#include "proto/monotonic_clock.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"

namespace disparityd::reaction {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Arguments {
    std::string programs = "build/release/bin";
    std::vector<std::string> settings;
    std::optional<double> seconds;
    std::optional<double> rate;
    std::optional<int> clients;
    std::optional<int> cores;
    bool markdown = false;

    double measured_s() const { return seconds.value_or(300); }
};

/// A folder that goes with this object.
class Folder {
public:
    Folder() : path_((std::filesystem::temp_directory_path() / "disparity-reaction-XXXXXX").string()) {
        if (::mkdtemp(path_.data()) == nullptr) {
            throw std::system_error(errno, std::generic_category(), path_);
        }
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string file(const std::string& name) const { return path_ + '/' + name; }

private:
    std::string path_;
};

/// Keeps this process and its children on the first cores that it may use.
void use_cores(int wanted) {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) {
        throw std::system_error(errno, std::generic_category(), "the cores of this process are not known");
    }
    cpu_set_t chosen;
    CPU_ZERO(&chosen);
    int found = 0;
    for (int core = 0; core < CPU_SETSIZE && found < wanted; ++core) {
        if (CPU_ISSET(core, &allowed)) {
            CPU_SET(core, &chosen);
            ++found;
        }
    }
    if (found < wanted) {
        throw std::invalid_argument("--cores: found " + std::to_string(wanted) + ", allowed: up to " +
                                    std::to_string(found) + " here");
    }
    if (::sched_setaffinity(0, sizeof chosen, &chosen) != 0) {
        throw std::system_error(errno, std::generic_category(), "--cores");
    }
}

/// Ctrl-C came before anything was measured.
struct Interrupted {};

void stop_if_interrupted() {
    if (tools::interrupted()) {
        throw Interrupted();
    }
}

/// Waits until the daemon has published a frame.
std::unique_ptr<disparity::SharedMemoryReader> first_reader(DaemonProcess& daemon, const std::string& name) {
    disparity::SharedMemoryOptions options;
    options.may_be_absent = true;
    auto reader = std::make_unique<disparity::SharedMemoryReader>(name, options);
    disparity::BorrowedFrame frame;
    const auto deadline = Clock::now() + 120s;
    while (reader->borrow(frame, 200ms) != disparity::ReadResult::frame) {
        stop_if_interrupted();
        daemon.check();
        if (Clock::now() > deadline) {
            throw std::runtime_error("no frame came from the daemon in two minutes");
        }
    }
    return reader;
}

/// Half of the other clients copy frames out of the shared memory, the others read the socket. Each adds up the depth.
std::vector<std::unique_ptr<handover::ReaderProcess>> other_clients(const Arguments& arguments, const std::string& name,
                                                                    const std::string& address) {
    std::vector<std::unique_ptr<handover::ReaderProcess>> clients;
    for (int i = 0; i < arguments.clients.value_or(20); ++i) {
        const auto way = i % 2 == 0 ? handover::Way::copy : handover::Way::socket;
        clients.push_back(std::make_unique<handover::ReaderProcess>(
            handover::ReaderOptions{way, name, address, arguments.measured_s() + 3600}));
    }
    return clients;
}

struct Measured {
    ReactionTimes::Result reactions;
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;
};

Measured measure(const Arguments& arguments, const PolePlan& plan, const std::vector<Pole>& poles,
                 disparity::SharedMemoryReader& reader, DaemonProcess& daemon) {
    ReactionTimes times(std::llround(1e9 / plan.rate), plan.without, plan.with);
    Measured measured;
    disparity::Frame frame;
    const auto end = Clock::now() + std::chrono::duration<double>(arguments.measured_s());
    tools::Progress progress("appearances", std::nullopt);
    while (Clock::now() < end && !tools::interrupted()) {
        const auto result = reader.read(frame, 500ms, {disparity::Product::scan});
        const std::int64_t now = proto::monotonic_ns();
        daemon.check();
        const auto scan = result == disparity::ReadResult::frame ? frame.scan() : std::nullopt;
        if (!scan) {
            continue;
        }
        const auto round = frame.sequence / static_cast<std::uint64_t>(plan.frames_per_round()) % poles.size();
        times.add({frame.sequence, now, frame.age_ns, shows(*scan, poles[round])});
        ++measured.frames;
        measured.dropped += frame.dropped_before;
        progress.show(static_cast<std::uint64_t>(times.result().appearances), "");
    }
    measured.reactions = times.result();
    return measured;
}

std::string at(const std::vector<std::int64_t>& sorted, double share, double unit_ns, int decimals) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size() - 1)));
    return tools::fixed(static_cast<double>(sorted[rank]) / unit_ns, decimals);
}

void print(const Arguments& arguments, const PolePlan& plan, Measured measured) {
    std::vector<std::int64_t>& times = measured.reactions.reactions_ns;
    if (times.empty()) {
        throw std::runtime_error("no pole was shown in " + std::to_string(measured.reactions.appearances) +
                                 " appearances: measure longer, or is the machine too slow for this rate?");
    }
    std::sort(times.begin(), times.end());
    const double period_ns = 1e9 / plan.rate;
    const auto late = std::count_if(times.begin(), times.end(),
                                    [&](std::int64_t time) { return static_cast<double>(time) > 2 * period_ns; });
    std::cout << plan.camera.width << " x " << plan.camera.height << " px at " << plan.rate << "/s, "
              << arguments.cores.value_or(2) << " cores, " << arguments.clients.value_or(20) << " other clients, "
              << measured.frames << " frames seen, " << measured.dropped << " dropped\n";
    tools::Table table({"appearances", "never shown", "shown before", "p50 ms", "p99 ms", "max ms", "p50 frames",
                        "p99 frames", "max frames", "later than 2 frames"});
    table.add({std::to_string(measured.reactions.appearances), std::to_string(measured.reactions.never_shown),
               std::to_string(measured.reactions.shown_before), at(times, 0.5, 1e6, 1), at(times, 0.99, 1e6, 1),
               at(times, 1, 1e6, 1), at(times, 0.5, period_ns, 2), at(times, 0.99, period_ns, 2),
               at(times, 1, period_ns, 2), std::to_string(late)});
    arguments.markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

int run(const Arguments& arguments) {
    const std::string program = arguments.programs + "/disparityd";
    if (::access(program.c_str(), X_OK) != 0) {
        throw std::invalid_argument(program + " cannot be run: build it, or say with --bin where it is");
    }
    use_cores(arguments.cores.value_or(2));
    tools::catch_interrupts();
    PolePlan plan;
    plan.rate = arguments.rate.value_or(plan.rate);
    const Folder folder;
    std::vector<Pole> poles;
    {
        tools::Progress progress("rounds drawn", static_cast<std::uint64_t>(plan.rounds));
        poles = write_pole_recording(folder.file("poles.mkv"), plan, [&](int done) {
            stop_if_interrupted();
            progress.show(static_cast<std::uint64_t>(done), "");
        });
    }
    const std::string name = "reaction-" + std::to_string(::getpid());
    const std::string address = "unix:" + folder.file("socket");
    std::vector<std::string> words{"--source", folder.file("poles.mkv"), "--name", name};
    std::vector<std::string> settings{"source.loop=true",  "source.policy=live",
                                      "scan.enabled=true", "match.disparities=128",
                                      "socket.tcp=",       "socket.unix=" + folder.file("socket")};
    settings.insert(settings.end(), arguments.settings.begin(), arguments.settings.end());
    for (const std::string& setting : settings) {
        words.insert(words.end(), {"--set", setting});
    }
    DaemonProcess daemon(program, words, folder.file("log"));
    const auto reader = first_reader(daemon, name);
    const auto clients = other_clients(arguments, name, address);
    print(arguments, plan, measure(arguments, plan, poles, *reader, daemon));
    return tools::exit_done;
}

}  // namespace
}  // namespace disparityd::reaction

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App app(
        "The time from the capture of a new pole's first frame until a client's read returns a scan that shows it.",
        "disparity-reaction");
    app.footer(
        "Example: disparity-reaction --bin build/release/bin --seconds 600\n"
        "It draws and records poles that appear on a floor, 1280x720, and plays that over and over in a daemon of its "
        "own,\n"
        "which reads it in real time and drops what is late, as of a camera. The others are processes: one half "
        "copies\n"
        "frames out of the shared memory, the other reads the socket, all products. All share the cores, so a machine "
        "that\n"
        "does other work shows that.\n"
        "frames: the same in intervals between frames. never shown, shown before: poles that no scan showed, and "
        "rounds with\n"
        "something at its place before it came.\n"
        "Exit status: 0 done; 1 the system or the daemon refused; 2 arguments must be changed.");
    reaction::Arguments arguments;
    app.add_option("--bin", arguments.programs, "where disparityd is; default build/release/bin")->type_name("DIR");
    app.add_option("--set", arguments.settings, "as disparityd has it; may be repeated")
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE");
    tools::add_real(app, "--seconds", arguments.seconds, 1, 86400,
                    "how long to measure, 2 s for an appearance; default 300");
    tools::add_real(app, "--rate", arguments.rate, 1, 200, "frames per second; default 15");
    tools::add_integer(app, "--clients", arguments.clients, 0, 250, "other clients; default 20");
    tools::add_integer(app, "--cores", arguments.cores, 1, 256, "of this machine, for all; default 2");
    app.add_flag("--markdown", arguments.markdown, "the table in Markdown");
    return tools::run_program(app, argc, argv, [&] {
        try {
            return reaction::run(arguments);
        } catch (const reaction::Interrupted&) {
            tools::print_note("stopped by " + tools::interrupted_by() + " before anything was measured");
            return static_cast<int>(tools::exit_interrupted);
        }
    });
}
