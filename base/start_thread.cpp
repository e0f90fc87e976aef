// SPDX-License-Identifier: Apache-2.0
#include "base/start_thread.h"

#include <initializer_list>
#include <stdexcept>

#include <pthread.h>
#include <sys/mman.h>

namespace disparityd::base {
namespace {

constexpr std::size_t usual_stack = std::size_t{8} << 20;
constexpr std::size_t bytes_per_mb = std::size_t{1} << 20;

std::size_t stack_bytes() {
    pthread_attr_t attributes;
    std::size_t bytes = usual_stack;
    if (pthread_getattr_default_np(&attributes) == 0) {
        pthread_attr_getstacksize(&attributes, &bytes);
        pthread_attr_destroy(&attributes);
    }
    return bytes;
}

/// Returns whether the process may have so many bytes more.
bool is_there_room(std::size_t bytes) {
    void* const stack = ::mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (stack == MAP_FAILED) {
        return false;
    }
    ::munmap(stack, bytes);
    return true;
}

}  // namespace

SignalsBlocked::SignalsBlocked() {
    sigset_t blocked;
    sigfillset(&blocked);
    for (const int kept : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT, SIGSYS, SIGPROF}) {
        sigdelset(&blocked, kept);
    }
    pthread_sigmask(SIG_BLOCK, &blocked, &before_);
}

SignalsBlocked::~SignalsBlocked() {
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void refuse_thread(const std::string& reason) {
    const std::size_t stack = stack_bytes();
    if (!is_there_room(stack)) {
        throw std::runtime_error("the system starts no more threads: there is no memory for the stack of " +
                                 std::to_string(stack / bytes_per_mb) +
                                 " MB that each has: raise the limit (ulimit -v) or choose fewer workers");
    }
    throw std::runtime_error("the system starts no more threads: " + reason +
                             ": allow more (ulimit -u, TasksMax= of a service, the pids limit of a container) or "
                             "choose fewer workers");
}

}  // namespace disparityd::base
