// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>

#include "base/failure_text.h"
#include "base/start_thread.h"
#include "base/words.h"
#include "capture/recording/recorder.h"
#include "capture/recording/recording_writer.h"
#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "proto/record_message.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/number_argument.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/daemon.h"
#include "tools/ctl/describe.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/processing/input_files.h"
#include "tools/ctl/recording/record_mcap.h"
#include "tools/ctl/source_arguments.h"

namespace disparityd::tools {
namespace {

/// Signals within this time count as one: timeout(1) sends two.
constexpr std::chrono::milliseconds one_signal{200};
/// Passes between a further signal and the end of the program: the request leaves in this time.
constexpr std::chrono::seconds last_moment{1};
constexpr std::chrono::milliseconds look_interval{50};

/// Ends the program soon after a further signal, as long as this lives. A daemon that has the request obeys, whether
/// somebody waits for the answer or not.
class EndedByAnotherSignal {
public:
    explicit EndedByAnotherSignal(std::string note)
        : note_(std::move(note)), thread_(base::start_thread([this] { watch(); })) {}
    ~EndedByAnotherSignal() {
        {
            const std::lock_guard lock(mutex_);
            done_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }
    EndedByAnotherSignal(const EndedByAnotherSignal&) = delete;
    EndedByAnotherSignal& operator=(const EndedByAnotherSignal&) = delete;

private:
    void watch() {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, one_signal, [this] { return done_; });
        const int before = interruptions();
        while (!done_ && interruptions() == before) {
            changed_.wait_for(lock, look_interval);
        }
        if (!changed_.wait_for(lock, last_moment, [this] { return done_; })) {
            print_note(note_);
            std::_Exit(exit_interrupted);
        }
    }

    const std::string note_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool done_ = false;
    std::thread thread_;
};

/// Asks the daemon to end its recording and waits until the file is closed. A signal that comes meanwhile
/// (catch_interrupts() with SecondSignal::is_kept) hastens this: the request is sent, and the program ends within a
/// second with exit_interrupted and a note, which names `stop`, the command for a daemon that has not done it.
/// Throws std::runtime_error with one line where the daemon refuses or does not answer in a minute.
v1::RecordStatus stop_recording_at_once(disparity::SocketClient& client, const std::string& stop) {
    std::optional<EndedByAnotherSignal> hastened;
    try {
        hastened.emplace("the daemon was told to stop recording and has not answered yet; if it goes on: " + stop);
    } catch (const std::exception&) {
        // Where no thread can be started, nothing hastens the stop.
    }
    return stop_daemon_recording(client);
}

using std::chrono::steady_clock;

struct RecordArguments {
    DaemonArguments daemon;
    std::string file;
    std::string source;
    std::string calibration;
    std::optional<int> seconds;
    std::optional<int> frames;
    std::optional<int> time_offset_us;
    std::string mcap;      ///< a file here of what the daemon sends; empty: none
    std::string contents;  ///< of that
    std::string camera;
    bool force = false;
    bool stop = false;
    bool json = false;
};

/// Tells when a recording must end: after the frames or seconds that the user asked for, or at Ctrl-C.
class Limit {
public:
    explicit Limit(const RecordArguments& arguments) : arguments_(arguments) {}

    bool reached(std::uint64_t frames) const {
        return interrupted() || (arguments_.frames && frames >= static_cast<std::uint64_t>(*arguments_.frames)) ||
               (arguments_.seconds && steady_clock::now() >= start_ + std::chrono::seconds(*arguments_.seconds));
    }

private:
    const RecordArguments& arguments_;
    steady_clock::time_point start_ = steady_clock::now();
};

std::optional<std::uint64_t> expected_frames(const RecordArguments& arguments, double rate,
                                             const std::optional<std::uint64_t>& available) {
    std::optional<std::uint64_t> least = available;
    const auto at_most = [&least](std::uint64_t frames) { least = std::min(least.value_or(frames), frames); };
    if (arguments.frames) {
        at_most(static_cast<std::uint64_t>(*arguments.frames));
    }
    if (arguments.seconds && rate > 0) {
        at_most(static_cast<std::uint64_t>(rate * *arguments.seconds));
    }
    return least;
}

std::string dropped_and_size(std::uint64_t dropped, std::uint64_t bytes) {
    return std::to_string(dropped) + " dropped, " + fixed(static_cast<double>(bytes) / 1e6, 1) + " MB";
}

/// Prints what was recorded and returns the exit code.
int report(const v1::RecordStatus& done, bool json, const std::string& why_none = {}) {
    if (json) {
        std::cout << to_text(to_json(done), 2) << '\n';
    } else if (done.frames() > 0) {
        std::cout << done.path() << ": " << base::counted(done.frames(), "frame") << " in " << fixed(done.seconds(), 1)
                  << " s, " << dropped_and_size(done.dropped(), done.bytes());
        if (done.lost() > 0) {
            std::cout << "; " << done.lost() << " lost by the source";
        }
        std::cout << '\n';
    }
    if (!done.error().empty()) {
        print_error(done.error() + (done.frames() == 0 ? "; nothing was recorded"
                                                       : "; what came before that is in " + done.path() + ": " +
                                                             base::counted(done.frames(), "frame")));
        return exit_failed;
    }
    if (done.frames() == 0 && interrupted()) {
        print_note("stopped by " + interrupted_by() + " before the first frame; nothing was recorded");
        return exit_interrupted;
    }
    if (done.frames() == 0) {
        print_error("no frame came" + (why_none.empty() ? "" : " (" + why_none + ")") + "; nothing was recorded");
        return exit_failed;
    }
    return exit_done;
}

int stop_recording(const RecordArguments& arguments) {
    if (!arguments.file.empty() || !arguments.source.empty()) {
        throw std::invalid_argument(
            "record: --stop ends what the daemon records, allowed beside it: where the daemon is");
    }
    disparity::Client client = connect(arguments.daemon);
    catch_interrupts(SecondSignal::is_kept);
    return report(stop_recording_at_once(client.socket(), command_of(arguments.daemon, "record --stop")),
                  arguments.json);
}

/// Asks the daemon to record. `stop` is the command that ends a recording.
v1::RecordStatus start_recording(disparity::SocketClient& client, const std::string& file, const std::string& stop) {
    constexpr std::chrono::seconds patience{5};
    const auto asked = steady_clock::now();
    try {
        return start_daemon_recording(client, file, patience);
    } catch (const std::runtime_error& error) {
        const bool answered = steady_clock::now() < asked + patience;
        throw std::runtime_error(std::string(error.what()) +
                                 (answered ? "" : "; it may record all the same later; to end that: " + stop));
    }
}

/// Shows how the daemon's recording goes on, until it has ended or must be ended. `now` is what the daemon said last.
/// `listener` is told at intervals: no question is open when a signal comes, so nothing is waited for then.
void show_until_limit(disparity::SocketClient& listener, const RecordArguments& arguments, double rate,
                      v1::RecordStatus& now) {
    Progress bar("frames", expected_frames(arguments, rate, {}));
    const Limit limit(arguments);
    disparity::Subscription state_only;
    state_only.products.clear();
    state_only.status_interval_s = 0.1;
    listener.subscribe(state_only);
    disparity::SensorBatch none;
    while (now.active() && !limit.reached(now.frames())) {
        const auto heard = listener.read_sensors(none, std::chrono::milliseconds(50));
        if (heard == disparity::ReadResult::gone && !listener.unanswered()) {
            throw std::runtime_error(listener.why_gone());
        }
        if (const auto told = pushed_status(listener)) {
            now = told->record();
            bar.show(now.frames(), dropped_and_size(now.dropped(), now.bytes()));
        }
    }
}

int record_with_daemon(const RecordArguments& arguments) {
    if (!arguments.calibration.empty() || arguments.force || arguments.time_offset_us) {
        throw std::invalid_argument(
            "record: --calibration, --time-offset-us and --force go with --source; without it the daemon records with "
            "its own configuration");
    }
    disparity::Client asking = connect(arguments.daemon);
    disparity::Client listening = connect(arguments.daemon);
    disparity::SocketClient& client = asking.socket();
    catch_interrupts(SecondSignal::is_kept);
    const v1::Status status = daemon_status(client);
    const std::string stop = command_of(arguments.daemon, "record --stop");
    if (status.record().active()) {
        throw std::runtime_error("the daemon records " + status.record().path() + " already; to end that: " + stop);
    }
    v1::RecordStatus now = start_recording(client, arguments.file, stop);
    show_until_limit(listening.socket(), arguments, status.rate(), now);
    // Where the daemon ended the recording (disk full, source gone), the status has the reason already.
    const v1::RecordStatus done = now.active() ? stop_recording_at_once(client, stop) : now;
    return report(done, arguments.json, done.frames() == 0 ? why_no_frame(arguments.daemon) : "");
}

/// Has the interface of capture::Recorder for sources that wait. It writes in the caller's thread and loses no frame.
class PatientRecorder {
public:
    PatientRecorder(const std::string& path, const capture::SourceInfo& info, bool overwrite)
        : writer_(path, info, overwrite) {}

    bool offer(const capture::RawFrame& frame) {
        writer_.write(frame);
        return true;
    }
    capture::Recorder::Status status() const {
        const std::chrono::duration<double> elapsed = steady_clock::now() - start_;
        return {writer_.frames(), 0, writer_.bytes(), elapsed.count(), {}, 0};
    }
    capture::Recorder::Status finish() {
        writer_.close();
        return status();
    }

private:
    capture::RecordingWriter writer_;
    steady_clock::time_point start_ = steady_clock::now();
};

/// Gives a frame back to its source at the end of the scope.
class Loan {
public:
    Loan(capture::FrameSource& source, const capture::RawFrame& frame) : source_(source), frame_(frame) {}
    ~Loan() { source_.give_back(frame_); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

private:
    capture::FrameSource& source_;
    const capture::RawFrame& frame_;
};

/// Removes a file that this program made. A pipe or a device stays.
void remove_file(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) {
        std::filesystem::remove(path, error);
    }
}

/// Records until the limit. `create` makes the recorder, and with it the file, when the first frame has come: a source
/// without frames neither creates nor replaces a file.
template <typename AnyRecorder>
int record_frames(const RecordArguments& arguments, capture::FrameSource& source,
                  const std::function<std::unique_ptr<AnyRecorder>()>& create) {
    catch_interrupts();
    std::unique_ptr<AnyRecorder> recorder;
    std::string fault;
    {
        Progress bar("frames", expected_frames(arguments, source.info().rate, source.info().frame_count));
        const Limit limit(arguments);
        capture::RawFrame frame;
        try {
            bool warned = false;
            for (std::uint64_t taken = 0; !limit.reached(taken);) {
                const auto got = source.next(frame, steady_clock::now() + std::chrono::milliseconds(100));
                if (got == capture::FrameSource::Next::frame) {
                    const Loan loan(source, frame);
                    recorder = recorder ? std::move(recorder) : create();
                    recorder->offer(frame);
                    ++taken;
                } else if (got != capture::FrameSource::Next::timeout) {
                    break;
                }
                const auto now = recorder ? recorder->status() : capture::Recorder::Status{};
                if (!now.error.empty()) {
                    break;
                }
                if (now.dropped > 0 && !warned) {
                    print_note(capture::Recorder::slow_disk_text(arguments.file));
                    warned = true;
                }
                bar.show(now.frames, dropped_and_size(now.dropped, now.bytes));
            }
        } catch (const std::exception& error) {
            if (!recorder && dynamic_cast<const std::invalid_argument*>(&error) != nullptr) {
                throw;  // the recorder refuses what the user must change
            }
            fault = base::failure_text(error);
        }
    }
    capture::Recorder::Status done = recorder ? recorder->finish() : capture::Recorder::Status{};
    if (done.error.empty()) {
        done.error = fault;
    }
    if (recorder && done.frames == 0) {
        remove_file(arguments.file);
    }
    return report(proto::record_message(done, arguments.file, false), arguments.json);
}

int record_source(const RecordArguments& arguments) {
    refuse_file_of_source(arguments.file, arguments.source);
    check_output(arguments.file, arguments.force);
    capture::SourceOptions options;
    options.uri = arguments.source;
    options.calibration_path = arguments.calibration;
    options.time_offset_us = arguments.time_offset_us.value_or(0);
    // What waits is copied as fast as it goes, unless so many seconds of it are wanted.
    options.pace = is_kept(arguments.source) && !arguments.seconds ? capture::Pace::fastest : capture::Pace::source;
    const auto source = open_with_progress(options);
    if (source->info().live) {
        return record_frames<capture::Recorder>(arguments, *source, [&] {
            return std::make_unique<capture::Recorder>(arguments.file, source->info(), 16, arguments.force);
        });
    }
    return record_frames<PatientRecorder>(arguments, *source, [&] {
        return std::make_unique<PatientRecorder>(arguments.file, source->info(), arguments.force);
    });
}

/// Adds what makes a file of messages here, of what the daemon sends.
void add_mcap(CLI::App& command, RecordArguments& arguments) {
    CLI::Option* const mcap =
        command
            .add_option("--mcap", arguments.mcap,
                        "instead of OUT: write what the daemon sends into this file here, as messages of ROS 2")
            ->type_name("FILE");
    for (const char* other : {"OUT", "--source", "--stop"}) {
        mcap->excludes(command.get_option(other));
    }
    command
        .add_option("--contents", arguments.contents,
                    "with --mcap: what the file has, as export --contents has it (raw: in grey); default " +
                        std::string(usual_recorded_parts))
        ->type_name("WORDS")
        ->needs(mcap);
    command
        .add_option("--camera-name", arguments.camera,
                    "with --mcap: topics are below /NAME, frames of reference begin with NAME_; default stereo")
        ->type_name("NAME")
        ->needs(mcap);
}

int record_messages(const RecordArguments& arguments) {
    if (!arguments.calibration.empty() || arguments.time_offset_us) {
        throw std::invalid_argument("record: --calibration and --time-offset-us go with --source");
    }
    McapRecordArguments mcap{.daemon = arguments.daemon,
                             .file = arguments.mcap,
                             .contents = arguments.contents,
                             .seconds = arguments.seconds,
                             .frames = arguments.frames,
                             .force = arguments.force,
                             .json = arguments.json};
    if (!arguments.camera.empty()) {
        mcap.camera = arguments.camera;
    }
    return record_mcap(mcap);
}

}  // namespace

void add_record(CLI::App& program, Action& action) {
    CLI::App& command =
        *program.add_subcommand("record", "Record raw frames, losslessly, with exact times and calibration.");
    const auto arguments = std::make_shared<RecordArguments>();
    command.add_option("OUT", arguments->file, "the recording to make, such as out.mkv");
    add_integer(command, "--seconds", arguments->seconds, 1, 1'000'000, "stop after this time");
    add_integer(command, "--frames", arguments->frames, 1, 1'000'000'000,
                "stop after this many frames (with a daemon: a few more may come)");
    command
        .add_option("--source", arguments->source, "open this source here, without a daemon; see disparityctl sources")
        ->type_name("URI");
    command.add_option("--calibration", arguments->calibration, "with --source: calibration instead of its own")
        ->type_name("FILE");
    add_time_offset(command, arguments->time_offset_us, "with --source: ");
    command.add_flag("--force", arguments->force, "with --source or --mcap: replace the file when it exists");
    command.add_flag("--stop", arguments->stop, "end the recording of the daemon, whoever started it");
    command.add_flag("--json", arguments->json, "one JSON object at the end");
    add_mcap(command, *arguments);
    arguments->daemon.add_to(command);
    command.footer(
        "Without --source a running daemon records the frames that it captures. OUT is then a new name that ends in\n"
        ".mkv, on the daemon's machine, relative to its folder for recordings. Over TCP a daemon refuses to record\n"
        "unless it is configured to. Ctrl-C, SIGTERM and a lost terminal end the recording; the file is valid. A "
        "second\n"
        "signal ends disparityctl within a second, once it has told the daemon to stop. When disparityctl is killed,\n"
        "the daemon continues to record until record --stop, unless it is configured otherwise. Exit status 0 when at\n"
        "least one frame was recorded and nothing failed; 130 when the signal came before the first frame, or the\n"
        "second one before the daemon's answer.\n"
        "With --mcap disparityctl is a client that writes FILE on this machine, until Ctrl-C or the limit: FILE grows\n"
        "under its own name, and what is whole in it can be read at any time. The daemon never waits: where disk or\n"
        "network are too slow, the newest frames win, and those that were dropped are told at the end.\n"
        "Examples: disparityctl record walk.mkv --seconds 60\n"
        "          disparityctl record scene.mkv --source scene:vga@15 --frames 30\n"
        "          disparityctl record --mcap walk.mcap --seconds 60\n"
        "          disparityctl record --mcap walk.mcap --contents raw,imu,tf");
    command.callback([arguments, &action] {
        action = [arguments] {
            if (arguments->stop) {
                return stop_recording(*arguments);
            }
            if (!arguments->mcap.empty()) {
                return record_messages(*arguments);
            }
            if (arguments->file.empty()) {
                throw std::invalid_argument("record: OUT is missing, the recording to make, such as out.mkv");
            }
            return arguments->source.empty() ? record_with_daemon(*arguments) : record_source(*arguments);
        };
    });
}

}  // namespace disparityd::tools
