// SPDX-License-Identifier: Apache-2.0
#include "base/device_file.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/ioctl.h>

namespace disparityd::base {

int open_device(const std::string& node) {
    const int device = ::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return device < 0 ? -errno : device;
}

int device_ioctl(int device, unsigned long request, void* argument) {
    int result = 0;
    do {
        result = ::ioctl(device, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
}

}  // namespace disparityd::base
