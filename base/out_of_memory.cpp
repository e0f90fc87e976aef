// SPDX-License-Identifier: Apache-2.0
#include "base/out_of_memory.h"

#include <exception>
#include <new>
#include <string_view>

#include <unistd.h>

namespace disparityd::base {
namespace {

thread_local int refusable = 0;
std::terminate_handler before = nullptr;

/// Allocates nothing and runs no destructor: they may wait for threads that have no memory either.
[[noreturn]] void end_with_a_line() {
    constexpr std::string_view line =
        "disparityd: error: out of memory: the system gives this program no more; end other programs, lower [socket] "
        "max_clients, or raise the limit (ulimit -v, MemoryMax= of a service)\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, line.data(), line.size());
    ::_exit(1);
}

void out_of_memory() {
    if (refusable > 0) {
        throw std::bad_alloc();
    }
    end_with_a_line();
}

/// Libraries throw std::bad_alloc themselves where malloc() gives nothing.
void terminated() {
    if (const auto exception = std::current_exception()) {
        try {
            std::rethrow_exception(exception);
        } catch (const std::bad_alloc&) {
            end_with_a_line();
        } catch (...) {  // NOLINT(bugprone-empty-catch): the handler before tells of it
        }
    }
    before();
}

}  // namespace

void end_when_out_of_memory() {
    std::set_new_handler(out_of_memory);
    before = std::set_terminate(terminated);
}

MemoryMayBeRefused::MemoryMayBeRefused() {
    ++refusable;
}

MemoryMayBeRefused::~MemoryMayBeRefused() {
    --refusable;
}

}  // namespace disparityd::base
