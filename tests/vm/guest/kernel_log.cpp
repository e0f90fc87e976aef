// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/kernel_log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "tests/vm/camera/file_descriptor.h"

namespace vm_guest {

namespace {

constexpr std::array<std::string_view, 7> signs{
    "WARNING: CPU", "BUG: ", "Oops:", "Call Trace", "kernel BUG", "blocked for more than", "use-after-free"};

}  // namespace

std::vector<std::string> kernel_complaints() {
    const simulated_camera::FileDescriptor log(::open("/dev/kmsg", O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    std::vector<std::string> found;
    if (!log) {
        return {"/dev/kmsg cannot be read"};
    }
    std::array<char, 8192> record;
    while (true) {
        const ssize_t length = ::read(log.get(), record.data(), record.size());
        if (length < 0 && errno == EPIPE) {
            continue;  // overwritten while it was read; the next one follows
        }
        if (length <= 0) {
            return found;
        }
        const std::string_view text(record.data(), static_cast<std::size_t>(length));
        const std::string_view line = text.substr(0, text.find('\n'));
        if (std::any_of(signs.begin(), signs.end(), [&](auto sign) { return line.find(sign) != line.npos; })) {
            found.emplace_back(line);
        }
    }
}

}  // namespace vm_guest
