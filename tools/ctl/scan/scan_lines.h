// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace disparityd::tools {

/// Writes lines to standard output for a program that reads them through a pipe. A pipe holds 64 KiB, so that a program
/// that works on each scan would read those of seconds ago: the next one is written when the last one was read.
class ScanLines {
public:
    ScanLines();

    /// Waits until all that was written has been read, `longest` at most, and returns whether it has. What is no pipe
    /// keeps nobody waiting.
    bool read(std::chrono::milliseconds longest) const;

    /// Writes a line. Ctrl-C ends the wait for room in a pipe, and what is left of the line is not written then. Throws
    /// std::runtime_error when it cannot be written.
    void put(const std::string& line);

private:
    bool pipe_ = false;
};

}  // namespace disparityd::tools
