// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/vm/guest/video_nodes.h"

namespace vm_guest {

/// A simulated camera that runs beside the test, plugged in and with a video node when the constructor is done. The
/// destructor ends it and waits until the kernel has taken its node away.
class CameraProcess {
public:
    explicit CameraProcess(std::vector<std::string> options = {});
    ~CameraProcess();
    CameraProcess(const CameraProcess&) = delete;
    CameraProcess& operator=(const CameraProcess&) = delete;

    /// Throws std::runtime_error when the camera refuses the command.
    std::string tell(const std::string& command) const;

    /// A number of the camera's status: plugged, streaming, sent, late, number.
    long counter(const std::string& name) const;

    /// Ends with the node gone.
    void unplug();
    /// Ends with a node there, maybe with another number.
    void plug(const std::string& as = "");

    const VideoNode& node() const { return node_; }

private:
    bool find_node();

    std::string socket_;
    pid_t process_ = -1;
    std::vector<std::string> nodes_before_;  // of other cameras
    VideoNode node_{};
};

}  // namespace vm_guest
