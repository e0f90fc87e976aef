// SPDX-License-Identifier: Apache-2.0
#include "base/write_all.h"

#include <cerrno>

#include <unistd.h>

namespace disparityd::base {

int write_all(int descriptor, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR) {
            return errno;
        }
        bytes = bytes.subspan(written < 0 ? 0 : static_cast<std::size_t>(written));
    }
    return 0;
}

}  // namespace disparityd::base
