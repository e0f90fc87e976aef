// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::test {

/// A pseudo-terminal: a program opens path() as its serial device, the test is at the other end of the line.
class TerminalPair {
public:
    static constexpr std::chrono::seconds patience{60};

    /// Throws std::runtime_error where the system has none.
    TerminalPair();
    /// For the program this is as unplugging the device.
    ~TerminalPair();
    TerminalPair(const TerminalPair&) = delete;
    TerminalPair& operator=(const TerminalPair&) = delete;

    const std::string& path() const { return path_; }

    /// Appends what the program has written, waits for some; false when none has come in time.
    bool read(std::vector<std::uint8_t>& bytes, std::chrono::milliseconds timeout = patience);

    /// Writes to the program until the line takes no more; returns how much that was.
    std::size_t fill();

    /// Waits until the line takes more.
    bool has_room(std::chrono::milliseconds timeout = patience);

private:
    int line_ = -1;    ///< the test's end
    int device_ = -1;  ///< held open, so that the line is never without a device
    std::string path_;
};

}  // namespace disparityd::test
