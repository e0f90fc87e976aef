// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/frame_source.h"
#include "capture/recorder.h"
#include "daemon/one_thread.h"
#include "proto/disparity.pb.h"

namespace disparityd {

/// Recordings that clients ask for: one at a time, inside one folder, never over an existing file. Files are opened and
/// finished in a thread of its own; the capture thread only hands over frames. Any thread may call anything.
class RecordingControl {
public:
    /// The state, or why the request was refused; called in a thread of this object.
    using Answer = std::function<void(const v1::RecordStatus& status, const std::string& refusal)>;

    RecordingControl() = default;
    ~RecordingControl();
    RecordingControl(const RecordingControl&) = delete;
    RecordingControl& operator=(const RecordingControl&) = delete;

    void configure(bool enabled, std::string directory);

    /// What will be recorded from now on; a running recording gets no more frames and is finished in the background,
    /// `reason` is what its status will say, empty = all is well.
    void set_source(std::optional<capture::SourceInfo> source, const std::string& reason);

    /// `path` is relative to the folder.
    void start(const std::string& path, Answer answer);
    void stop(Answer answer);

    /// Waits until a recording that gets no more frames is finished. Not to be called by an Answer.
    void wait();

    /// Finishes a recording that has failed by itself, warns once of one that loses frames; to be called now and then,
    /// by one thread.
    void check();

    v1::RecordStatus status() const;

    /// A raw frame, in the capture thread. Never blocks for long, allocates nothing.
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

    // In the worker; finish_ended() also when there is none any more.
    void start_now(const std::string& path);
    void finish_ended();

    std::string slow_;          ///< path of the recording that was warned of; check()'s own
    mutable std::mutex mutex_;  ///< everything below but the worker; held shortly
    bool enabled_ = true;
    std::string directory_;
    std::optional<capture::SourceInfo> source_;
    unsigned source_number_ = 0;  ///< counts set_source()
    std::string path_;
    std::shared_ptr<capture::Recorder> recorder_;
    Ended ended_;            ///< until the worker takes it to finish it; nothing is started before
    v1::RecordStatus last_;  ///< of the recording that is being finished, or of the one before
    boost::asio::thread_pool worker_ = one_thread();
};

}  // namespace disparityd
