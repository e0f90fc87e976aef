// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::handover {

/// How a reader gets its frames.
enum class Way {
    copy,
    borrow,
    socket,
    work  ///< from the socket, and works for a while on each frame
};

struct ReaderOptions {
    Way way = Way::copy;
    std::string name;     ///< of the shared memory
    std::string address;  ///< of the socket, for Way::socket and Way::work
    double seconds = 10;
    double work_s = 0;                                                   ///< Way::work: on each frame
    std::vector<disparity::Product> products{disparity::Product::scan};  ///< Way::work asks for these
    disparity::ConnectOptions connect{};                                 ///< Way::work: for a daemon with TLS
};

/// What one reader saw.
struct Seen {
    std::vector<std::int64_t> handover_ns;   ///< from publishing to the return of the read, one for each frame
    std::vector<std::int64_t> age_ns;        ///< Way::work: from capture to the return of the read, one for each frame
    std::vector<std::int64_t> told_less_ns;  ///< Way::work: the age that the library tells, less that one
    std::uint64_t skipped = 0;               ///< frames that the reader did not see
    std::uint64_t untimed = 0;               ///< frames of which nothing says when they were published
    std::uint64_t torn = 0;                  ///< borrowed frames that were written over before their depth was added up
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
