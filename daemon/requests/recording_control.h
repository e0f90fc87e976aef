// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/frame_source.h"
#include "capture/recording/recorder.h"
#include "daemon/log.h"
#include "daemon/one_thread.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// The rules for recordings of clients.
struct RecordRules {
    bool enabled = true;
    std::string directory;
    bool directory_is_chosen = true;    ///< else only the daemon's own user and root may record
    std::uint64_t keep_free_bytes = 0;  ///< that every recording leaves on its disk
    std::uint64_t max_bytes = 0;        ///< of a recording; 0 = no limit
    std::chrono::seconds max_time{0};   ///< of a recording; 0 = no limit
    bool ends_with_client = false;      ///< when the connection of the client that asked for it has ended
};

/// What a client wants to have recorded, and who it is.
struct WantedRecording {
    std::string path;          ///< as the client wrote it
    bool owner = false;        ///< Requester::owns_daemon
    std::uint64_t client = 0;  ///< Requester::client
};

/// Makes the recordings that clients ask for: one at a time, inside one folder, never over an existing file. A
/// recording without a frame leaves no file. A thread of its own opens and finishes files; the capture thread only
/// offers frames. Any thread may call any function unless it says otherwise.
class RecordingControl {
public:
    /// Takes the state, or why the request was refused. Called in a thread of this object.
    using Answer = std::function<void(const v1::RecordStatus& status, const std::string& refusal)>;

    RecordingControl() = default;
    ~RecordingControl();
    RecordingControl(const RecordingControl&) = delete;
    RecordingControl& operator=(const RecordingControl&) = delete;

    void configure(RecordRules rules);

    /// Sets the source of the next recordings. A running recording gets no more frames and is finished in the
    /// background; its status says `reason`, empty = no error.
    void set_source(std::optional<capture::SourceInfo> source, const std::string& reason);

    /// Starts a recording. Its path is relative to the folder, each part begins with a letter or digit, and it ends in
    /// ".mkv".
    void start(const WantedRecording& wanted, Answer answer);
    void stop(Answer answer);

    /// Waits until a recording that gets no more frames is finished. Not to be called by an Answer.
    void wait();

    /// Ends the recording of this client if RecordRules::ends_with_client.
    void client_is_gone(std::uint64_t client);

    /// Finishes a recording that has failed or reached a limit; warns once of one that loses frames. One thread calls
    /// this several times a second. Never waits for a disk.
    void check();

    v1::RecordStatus status() const;

    /// Returns whether a recording runs.
    bool is_recording() const;

    /// Returns whether a recording runs that this client has asked for.
    bool is_recording_for(std::uint64_t client) const;

    /// Copies a raw frame for the running recording, if there is one. The capture thread alone calls this. Never waits
    /// for a disk, allocates nothing.
    void offer(const capture::RawFrame& frame) noexcept;

private:
    /// A recording that gets no more frames.
    struct Ended {
        std::shared_ptr<capture::Recorder> recorder;  ///< null: there is none
        std::string path;
        std::string reason;
    };

    // With mutex_ held.
    bool end(const std::string& reason);
    void end_in_background(const std::string& reason);
    v1::RecordStatus current() const;
    std::string limit_reached(const v1::RecordStatus& now) const;
    void watch_space();

    // In the worker; finish_ended() also when there is none any more.
    void start_now(const WantedRecording& wanted);
    void finish_ended();
    void look_for_space();

    std::string slow_;          ///< path of the recording that was warned of; check()'s own
    mutable std::mutex mutex_;  ///< everything below but the worker; held shortly
    RecordRules rules_;
    std::optional<capture::SourceInfo> source_;
    unsigned source_number_ = 0;  ///< counts set_source()
    std::string path_;
    std::shared_ptr<capture::Recorder> recorder_;
    std::uint64_t client_ = 0;        ///< that has asked for it
    bool looking_for_space_ = false;  ///< the worker is to look, or does
    Ended ended_;                     ///< until the worker takes it to finish it; nothing is started before
    v1::RecordStatus last_;           ///< of the recording that is being finished, or of the one before

    // The worker's.
    LogLimiter began_;
    LogLimiter finished_;
    LogLimiter broke_off_;

    boost::asio::thread_pool worker_ = one_thread();
};

}  // namespace disparityd::daemon
