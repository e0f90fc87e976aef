// SPDX-License-Identifier: Apache-2.0
//
// Linked into a test program: whatever its tests did, the kernel must not have complained.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/vm/camera/file_descriptor.h"

namespace vm_guest {
namespace {

constexpr std::array<std::string_view, 7> signs{
    "WARNING: CPU", "BUG: ", "Oops:", "Call Trace", "kernel BUG", "blocked for more than", "use-after-free"};

using Lines = std::vector<std::string>;

bool has(const std::string& line, std::string_view text) {
    return line.find(text) != std::string::npos;
}

/// vivid, when the machine is late, wants to sleep for less than no time: the kernel shows a trace, and all is well.
/// The last line of such a trace if one begins here, else `line`.
Lines::const_iterator skip_late_vivid(Lines::const_iterator line, const Lines& log) {
    if (!has(*line, "schedule_timeout: wrong timeout value")) {
        return line;
    }
    const auto last = std::find_if(line, log.end(), [](const std::string& each) { return has(each, "</TASK>"); });
    const bool is_vivid = std::any_of(line, last, [](const std::string& each) { return has(each, "[vivid]"); });
    return is_vivid && last != log.end() ? last : line;
}

/// All lines of the kernel's log, the oldest first.
std::vector<std::string> kernel_log() {
    const simulated_camera::FileDescriptor log(::open("/dev/kmsg", O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    if (!log) {
        return {"BUG: /dev/kmsg cannot be read"};
    }
    std::vector<std::string> lines;
    std::array<char, 8192> record;
    while (true) {
        const ssize_t length = ::read(log.get(), record.data(), record.size());
        if (length < 0 && errno == EPIPE) {
            continue;  // overwritten while it was read; the next one follows
        }
        if (length <= 0) {
            return lines;
        }
        const std::string_view text(record.data(), static_cast<std::size_t>(length));
        lines.emplace_back(text.substr(0, text.find('\n')));
    }
}

/// Lines of the kernel's log that tell of a fault in the kernel: warnings with a trace, bugs, oopses, stuck tasks.
std::vector<std::string> kernel_complaints() {
    const Lines log = kernel_log();
    Lines found;
    for (auto line = log.begin(); line != log.end(); ++line) {
        line = skip_late_vivid(line, log);
        if (std::any_of(signs.begin(), signs.end(), [&](std::string_view sign) { return has(*line, sign); })) {
            found.push_back(*line);
        }
    }
    return found;
}

class NoKernelComplaints : public testing::Environment {
public:
    void TearDown() override {
        const auto complaints = kernel_complaints();
        EXPECT_THAT(complaints, testing::IsEmpty());
        if (!complaints.empty()) {
            const auto log = kernel_log();
            const std::size_t shown = std::min<std::size_t>(log.size(), 100);
            for (auto line = log.end() - static_cast<std::ptrdiff_t>(shown); line != log.end(); ++line) {
                std::printf("%s\n", line->c_str());
            }
        }
        // That a complaint would have been seen.
        std::ofstream("/dev/kmsg") << "a test writes WARNING: CPU" << std::endl;
        EXPECT_THAT(kernel_complaints(), testing::SizeIs(complaints.size() + 1));
    }
};

const auto* const environment = testing::AddGlobalTestEnvironment(new NoKernelComplaints);

}  // namespace

}  // namespace vm_guest
