// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace vm_guest {

/// A program in the background that prints a line for each frame that it reads; ended with the object.
class ReadingProgram {
public:
    /// The first argument is the program's path. Programs of the guest's own /usr find their libraries themselves.
    explicit ReadingProgram(std::vector<std::string> arguments);
    ~ReadingProgram();
    ReadingProgram(const ReadingProgram&) = delete;
    ReadingProgram& operator=(const ReadingProgram&) = delete;

    /// Whether two more lines come from now on: the first may be of a frame that was read before.
    bool goes_on() const;

    /// All that it has printed, errors too.
    std::string said() const;

private:
    std::string file_;
    pid_t process_ = -1;
};

}  // namespace vm_guest
