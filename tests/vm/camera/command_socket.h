// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tests/vm/camera/file_descriptor.h"

namespace simulated_camera {

/// Where commands come from: a Unix socket of packets, each packet a command, each answered with a packet.
class CommandSocket {
public:
    /// Throws std::runtime_error when the path cannot be used.
    explicit CommandSocket(const std::string& path);

    int listener() const { return listener_.get(); }

    /// Takes a connection, answers its one command and closes it.
    void serve(const std::function<std::string(const std::string&)>& carry_out);

private:
    FileDescriptor listener_;
};

/// Sends a command to the camera at this path and waits for the answer; "error: ..." when nobody is there.
std::string send_command(const std::string& path, const std::string& command);

}  // namespace simulated_camera
