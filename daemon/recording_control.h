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

    /// What will be recorded from now on; a running recording is finished, `reason` says why.
    void set_source(std::optional<capture::SourceInfo> source, const std::string& reason);

    /// `path` is relative to the folder.
    void start(const std::string& path, Answer answer);
    void stop(Answer answer);

    /// Finishes a running recording; `reason` is what its status will say, empty = all is well.
    void finish(const std::string& reason);

    /// Finishes a recording that has failed by itself, warns once of one that loses frames; to be called now and then,
    /// by one thread.
    void check();

    v1::RecordStatus status() const;

    /// A raw frame, in the capture thread. Never blocks for long, allocates nothing.
    void offer(const capture::RawFrame& frame) noexcept;

private:
    void start_now(const std::string& path);

    std::mutex operation_;      ///< one start or finish at a time; held while files are opened and closed
    mutable std::mutex mutex_;  ///< everything below; held shortly
    bool enabled_ = true;
    std::string directory_;
    std::optional<capture::SourceInfo> source_;
    std::string path_;
    std::string slow_;  ///< path of the recording that was warned of
    std::shared_ptr<capture::Recorder> recorder_;
    v1::RecordStatus last_;  ///< of the recording before
    boost::asio::thread_pool worker_ = one_thread();
};

}  // namespace disparityd
