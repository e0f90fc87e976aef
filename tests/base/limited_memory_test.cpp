// SPDX-License-Identifier: Apache-2.0
//
// A limit of the memory, as ulimit -v sets it: threads that have no room for their stacks, and the end of a program.
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <new>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/out_of_memory.h"
#include "base/program_end.h"
#include "base/start_thread.h"

namespace disparityd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Bytes of addresses that this process has.
rlim_t addresses() {
    rlim_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// Lasts as long as this lives.
class MemoryLimit {
public:
    explicit MemoryLimit(rlim_t bytes) {
        EXPECT_EQ(getrlimit(RLIMIT_AS, &before_), 0);
        const rlimit now{bytes, before_.rlim_max};
        EXPECT_EQ(setrlimit(RLIMIT_AS, &now), 0);
    }
    ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

private:
    rlimit before_{};
};

std::string refusal() {
    try {
        base::start_thread([] {}).join();
        return "started";
    } catch (const std::runtime_error& error) {
        return error.what();
    }
}

TEST(LimitedMemory, IsTheCauseThatAThreadIsRefusedFor) {
    {
        const MemoryLimit little(addresses() + (rlim_t{1} << 20));
        EXPECT_THAT(refusal(),
                    AllOf(HasSubstr("no memory for the stack"), HasSubstr("ulimit -v"), Not(HasSubstr("ulimit -u"))));
    }
    EXPECT_EQ(refusal(), "started");
    EXPECT_THAT([] { base::refuse_thread("no more"); }, testing::ThrowsMessage<std::runtime_error>(AllOf(
                                                            HasSubstr("no more: allow more"), HasSubstr("ulimit -u"))));
}

// Like the destructor of a library that waits for a thread which was never started.
[[noreturn]] void wait_for_ever() {
    while (true) {
        pause();
    }
}

TEST(LimitedMemory, EndsAProgramWhateverItsLibrariesWaitFor) {
    const auto program = [] {
        alarm(60);
        std::atexit([] { wait_for_ever(); });
        const MemoryLimit limit(addresses() + (rlim_t{64} << 20));
        std::exit(base::end_program(3));
    };
    EXPECT_EXIT(program(), testing::ExitedWithCode(3), "");
}

TEST(LimitedMemory, AProgramWithoutLimitGoesToItsEnd) {
    EXPECT_EQ(base::end_program(3), 3);
}

constexpr const char* one_line = "^disparityd: error: out of memory: [^\n]*\n$";

/// Takes memory until there is none. A destructor that ran at the end of the program would wait for ever.
void take_all() {
    const MemoryLimit limit(addresses() + (rlim_t{64} << 20));
    std::vector<std::vector<char>> taken;
    while (true) {
        taken.emplace_back(1000);
    }
}

TEST(OutOfMemory, EndsTheProgramWithALine) {
    const auto program = [] {
        alarm(60);
        std::atexit([] { wait_for_ever(); });
        base::end_when_out_of_memory();
        take_all();
    };
    EXPECT_EXIT(program(), testing::ExitedWithCode(1), one_line);
}

TEST(OutOfMemory, EndsTheProgramWhereALibraryThrowsByItself) {
    const auto program = [] {
        base::end_when_out_of_memory();
        std::thread([] { throw std::bad_alloc(); }).join();
    };
    EXPECT_EXIT(program(), testing::ExitedWithCode(1), one_line);
}

TEST(OutOfMemory, OtherFailuresAreToldAsBefore) {
    const auto program = [] {
        base::end_when_out_of_memory();
        std::thread([] { throw std::runtime_error("a bug"); }).join();
    };
    EXPECT_EXIT(program(), testing::KilledBySignal(SIGABRT), "a bug");
}

TEST(OutOfMemory, IsThrownToWorkThatCanBeRefused) {
    const auto program = [] {
        base::end_when_out_of_memory();
        {
            const base::MemoryMayBeRefused refusable;
            EXPECT_THROW(take_all(), std::bad_alloc);
        }
        take_all();
    };
    EXPECT_EXIT(program(), testing::ExitedWithCode(1), one_line);
}

}  // namespace
}  // namespace disparityd::test
