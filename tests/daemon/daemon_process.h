// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/temporary_folder.h"

namespace disparityd::test {

/// The real disparityd (or another program of the tests) as a child process; killed at the end if it still runs.
class DaemonProcess {
public:
    /// How long the tests wait for what must come: far longer than a slow machine needs.
    static constexpr std::chrono::seconds patience{60};

    using Environment = std::vector<std::pair<std::string, std::string>>;

    /// Arguments beside the name; its standard error goes to a file in `folder`.
    DaemonProcess(const TemporaryFolder& folder, std::vector<std::string> arguments,
                  const Environment& environment = {}, const std::string& program = DISPARITYD_PROGRAM);
    ~DaemonProcess();
    DaemonProcess(const DaemonProcess&) = delete;
    DaemonProcess& operator=(const DaemonProcess&) = delete;

    /// Waits for "ready"; needs --print-address. False when it ends or the time passes before.
    bool wait_until_ready(std::chrono::milliseconds timeout = patience);

    /// Reads its standard output up to a line that `wanted` takes. False when it ends or the time passes before.
    bool wait_for_line(const std::function<bool(const std::string&)>& wanted,
                       std::chrono::milliseconds timeout = patience);

    /// The first address with this start, such as "tcp:"; empty when there is none.
    std::string address(const std::string& prefix) const;

    void send_signal(int signal) const;
    pid_t pid() const { return pid_; }

    /// The exit status, 128 + n when ended by signal n; nothing when it still runs after the time.
    std::optional<int> wait_for_exit(std::chrono::milliseconds timeout = patience);

    /// What it wrote to standard output after the addresses.
    std::string output() const { return output_; }

    std::string log() const;
    bool wait_for_log(const std::string& text, std::chrono::milliseconds timeout = patience) const;

    /// Peak of its resident memory, MiB.
    double peak_memory_mib() const;

private:
    bool read_line(std::string& line, std::chrono::steady_clock::time_point deadline);

    std::string log_path_;
    pid_t pid_ = -1;
    int stdout_ = -1;
    std::string unread_;
    std::string output_;
    std::vector<std::string> addresses_;
    std::optional<int> exit_status_;
};

}  // namespace disparityd::test
