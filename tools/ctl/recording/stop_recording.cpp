// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/stop_recording.h"

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "base/start_thread.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/ctl/status_message.h"

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

}  // namespace

v1::RecordStatus stop_recording_at_once(disparity::SocketClient& client, const std::string& stop) {
    std::optional<EndedByAnotherSignal> hastened;
    try {
        hastened.emplace("the daemon was told to stop recording and has not answered yet; if it goes on: " + stop);
    } catch (const std::exception&) {
        // Where no thread can be started, nothing hastens the stop.
    }
    return stop_daemon_recording(client);
}

}  // namespace disparityd::tools
