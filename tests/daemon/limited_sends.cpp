// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/limited_sends.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <limits>
#include <mutex>

#include <dlfcn.h>
#include <sys/socket.h>
#include <sys/uio.h>

namespace {

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

std::atomic<std::size_t> most_bytes{unlimited};
std::atomic<std::uint64_t> calls{0};
std::mutex mutex;
disparityd::test::limited_sends::Failures failures;
std::atomic<std::uint64_t> shutdown_calls{0};

int error_of(std::uint64_t call) {
    const std::lock_guard lock(mutex);
    const bool fails = call == failures.first ||
                       (failures.every != 0 && call > failures.first && (call - failures.first) % failures.every == 0);
    return fails ? failures.error : 0;
}

}  // namespace

namespace disparityd::test::limited_sends {

void limit(std::size_t bytes, const Failures& wanted) {
    const std::lock_guard lock(mutex);
    calls = 0;
    most_bytes = bytes;
    failures = wanted;
}

void stop() {
    limit(unlimited);
}

std::uint64_t shutdowns() {
    return shutdown_calls;
}

}  // namespace disparityd::test::limited_sends

// In the place of the C library's, which they call.
extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
    using Send = ssize_t(int, const msghdr*, int);
    static auto* const send = reinterpret_cast<Send*>(dlsym(RTLD_NEXT, "sendmsg"));
    if (const int error = error_of(calls.fetch_add(1)); error != 0) {
        errno = error;
        return -1;
    }
    std::array<iovec, 64> parts{};
    msghdr limited = *message;
    limited.msg_iov = parts.data();
    limited.msg_iovlen = std::min(message->msg_iovlen, parts.size());
    std::size_t left = most_bytes;
    for (std::size_t i = 0; i < limited.msg_iovlen; ++i) {
        parts[i] = message->msg_iov[i];
        parts[i].iov_len = std::min(parts[i].iov_len, left);
        left -= parts[i].iov_len;
    }
    return send(socket, &limited, flags);
}

extern "C" int shutdown(int socket, int how) noexcept {
    using Shutdown = int(int, int);
    static auto* const end = reinterpret_cast<Shutdown*>(dlsym(RTLD_NEXT, "shutdown"));
    ++shutdown_calls;
    return end(socket, how);
}
