// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

namespace disparityd::handover {

/// How a reader gets its frames.
enum class Way { copy, borrow, socket };

struct ReaderOptions {
    Way way = Way::copy;
    std::string name;     ///< of the shared memory
    std::string address;  ///< of the socket, for Way::socket
    double seconds = 10;
};

/// What one reader saw.
struct Seen {
    std::vector<std::int64_t> handover_ns;  ///< from publishing to the return of the read, one for each frame
    std::uint64_t missed = 0;               ///< frames that the reader did not see
    std::uint64_t untimed = 0;              ///< frames of which nothing says when they were published
    std::uint64_t torn = 0;                 ///< borrowed frames that were written over before their depth was added up
};

/// A reader in a process of its own, as clients are: it reads all products and adds up the depth of each frame.
class ReaderProcess {
public:
    /// Starts to read. Throws std::system_error when the system starts no more processes.
    explicit ReaderProcess(const ReaderOptions& options);
    ~ReaderProcess();
    ReaderProcess(const ReaderProcess&) = delete;
    ReaderProcess& operator=(const ReaderProcess&) = delete;

    /// Waits for its end. Throws std::runtime_error when it failed; it has said why on standard error.
    Seen wait();

private:
    pid_t pid_ = -1;
    int results_ = -1;
};

}  // namespace disparityd::handover
