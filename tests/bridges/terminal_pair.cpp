// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/terminal_pair.h"

#include <array>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace disparityd::test {

TerminalPair::TerminalPair() : line_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    std::array<char, 128> name{};
    if (line_ < 0 || ::grantpt(line_) != 0 || ::unlockpt(line_) != 0 ||
        ::ptsname_r(line_, name.data(), name.size()) != 0) {
        throw std::runtime_error("no pseudo-terminal");
    }
    path_ = name.data();
    device_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
}

TerminalPair::~TerminalPair() {
    ::close(device_);
    ::close(line_);
}

bool TerminalPair::read(std::vector<std::uint8_t>& bytes, std::chrono::milliseconds timeout) {
    pollfd waiting{line_, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(timeout.count())) <= 0) {
        return false;
    }
    std::array<std::uint8_t, 4096> got{};
    const ssize_t size = ::read(line_, got.data(), got.size());
    if (size <= 0) {
        return false;
    }
    bytes.insert(bytes.end(), got.begin(), got.begin() + size);
    return true;
}

std::size_t TerminalPair::fill() {
    const std::array<std::uint8_t, 1024> junk{0xfd, 0x55};
    std::size_t written = 0;
    for (ssize_t size = 0; (size = ::write(line_, junk.data(), junk.size())) > 0;) {
        written += static_cast<std::size_t>(size);
    }
    return written;
}

bool TerminalPair::has_room(std::chrono::milliseconds timeout) {
    pollfd waiting{line_, POLLOUT, 0};
    return ::poll(&waiting, 1, static_cast<int>(timeout.count())) > 0 && (waiting.revents & POLLOUT) != 0;
}

}  // namespace disparityd::test
