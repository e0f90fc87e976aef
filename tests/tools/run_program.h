// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace disparityd::test {

/// How a program ended and what it said.
struct Outcome {
    int exit_code = 0;  ///< 128 + N when signal N ended it
    std::string out;
    std::string err;
};

/// A program under way; killed when it still runs at the end of the object's life. Cross-built programs start through
/// the emulator that the build names.
class Program {
public:
    /// Starts it with its output in temporary files. Throws std::runtime_error when that fails.
    Program(const std::string& path, const std::vector<std::string>& arguments);
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    void send(int signal) const;
    bool running();

    /// Whether its output holds the text by now.
    bool said(const std::string& text) const;

    /// Waits for its end. Throws std::runtime_error when it does not come within two minutes.
    Outcome wait();

private:
    pid_t pid_ = -1;
    int out_ = -1;
    int err_ = -1;
    int wait_status_ = 0;
    bool ended_ = false;
};

/// Starts a program and waits for its end.
Outcome run(const std::string& path, const std::vector<std::string>& arguments);

/// Polls until the condition holds; false when that takes longer than two minutes.
bool eventually(const std::function<bool()>& condition);

}  // namespace disparityd::test
