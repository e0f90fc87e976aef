// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/cpp/disparity_client.hpp"
#include "proto/disparity.pb.h"
#include "tests/daemon/daemon_process.h"
#include "tests/vm/guest/waiting.h"

namespace vm_guest {

/// disparityd on a camera, and one client that stays connected from the start to the end; a connection that the daemon
/// ends is an exception. Everything that comes is read by whoever waits for something.
class LiveDaemon {
public:
    using Status = disparityd::v1::Status;

    /// `program`: disparityd, or what starts it. Serves unrectified frames, matched as fast as can be.
    explicit LiveDaemon(const std::string& uri, const std::string& program = "/vm/disparityd",
                        const std::vector<std::string>& settings = {});

    /// Whether a status comes that fulfils the condition.
    bool wait_for(const std::function<bool(const Status&)>& condition);
    /// Whether the camera gets into this state, as the client sees it.
    bool wait_for_camera(const std::string& state);
    /// Whether a frame comes that was captured after this call.
    bool wait_for_new_frame();
    /// Whether frames come for so long that the daemon no longer counts what it tried before.
    bool recovers();

    /// Has the configuration loaded again; throws std::runtime_error unless the new chain takes over.
    void reload();

    /// Asks for it.
    Status status();

    const disparity::Frame& frame() const { return frame_; }
    disparity::SocketClient& client() { return *client_; }
    const std::string& name() const { return name_; }
    std::string address() const { return process_.address("tcp:"); }
    std::string log() const { return process_.log(); }
    const std::string& folder() const { return folder_.path(); }

    /// What a leak would make grow.
    struct Resources {
        long descriptors = 0;
        long video_maps = 0;  ///< mapped buffers of video nodes
        long threads = 0;
        bool operator==(const Resources&) const = default;
    };
    Resources resources() const;
    /// Whether nothing is left but this; connections and threads take a moment to end.
    bool comes_back_to(const Resources& before);

private:
    void read_once();

    std::string name_;
    disparityd::test::TemporaryFolder folder_;
    disparityd::test::DaemonProcess process_;
    std::optional<disparity::SocketClient> client_;
    disparity::Frame frame_;
    std::uint64_t frames_ = 0;
    std::optional<Status> newest_;  // not yet seen by wait_for()
};

/// What a failed test shows of a status.
std::string in_words(const LiveDaemon::Status& status);

/// CLOCK_MONOTONIC.
std::int64_t monotonic_ns();

std::ostream& operator<<(std::ostream& out, const LiveDaemon::Resources& resources);

/// The number of the pattern whose left eye's luma this is, if every pixel is right; numbers below 65536.
std::optional<std::uint32_t> number_of_left_picture(const disparity::PlaneData& left);

}  // namespace vm_guest
