// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_lines.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <iostream>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/command_line/interrupt.h"

namespace disparityd::tools {
namespace {

[[noreturn]] void fail() {
    throw std::runtime_error("standard output cannot be written");
}

/// Waits until PIPE_BUF bytes can be written, or the reader is gone. Returns false when Ctrl-C came first.
bool wait_for_room() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    while (::poll(&output, 1, 100) <= 0) {
        if (interrupted()) {
            return false;
        }
    }
    return true;
}

bool reader_is_gone() {
    pollfd output{STDOUT_FILENO, 0, 0};
    return ::poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0;
}

}  // namespace

ScanLines::ScanLines() {
    struct stat output {};
    pipe_ = ::fstat(STDOUT_FILENO, &output) == 0 && S_ISFIFO(output.st_mode);
}

bool ScanLines::read(std::chrono::milliseconds longest) const {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (pipe_) {
        int unread = 0;
        if (::ioctl(STDOUT_FILENO, FIONREAD, &unread) != 0 || unread == 0 || reader_is_gone()) {
            return true;  // put() finds out what is wrong
        }
        if (interrupted() || std::chrono::steady_clock::now() >= end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));  // nothing says when a pipe has been read
    }
    return true;
}

void ScanLines::put(const std::string& line) {
    if (!pipe_) {
        std::cout << line << std::endl;
        if (!std::cout) {
            fail();
        }
        return;
    }
    const std::string text = line + '\n';
    for (std::string_view rest = text; !rest.empty();) {
        if (!wait_for_room()) {
            return;
        }
        const ssize_t written = ::write(STDOUT_FILENO, rest.data(), std::min<std::size_t>(rest.size(), PIPE_BUF));
        if (written < 0 && errno != EINTR && errno != EAGAIN) {
            fail();
        }
        rest.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    }
}

}  // namespace disparityd::tools
