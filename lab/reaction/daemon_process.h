// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace disparityd::reaction {

/// disparityd as a child; stopped at the end.
class DaemonProcess {
public:
    /// Starts a program with these arguments; what it says goes to the file `log`. Throws std::system_error when the
    /// system starts no more processes.
    DaemonProcess(const std::string& program, const std::vector<std::string>& arguments, const std::string& log);
    ~DaemonProcess();
    DaemonProcess(const DaemonProcess&) = delete;
    DaemonProcess& operator=(const DaemonProcess&) = delete;

    /// Throws std::runtime_error, with the last line that it has said, when it has ended.
    void check();

private:
    std::string program_;
    std::string log_;
    pid_t pid_ = -1;
};

}  // namespace disparityd::reaction
