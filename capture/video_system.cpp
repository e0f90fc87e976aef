// SPDX-License-Identifier: Apache-2.0
#include "capture/video_system.h"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "capture/usb_reset.h"

namespace disparityd::capture {

namespace {

using std::chrono::steady_clock;

class LinuxVideoSystem final : public VideoSystem {
public:
    std::vector<UsbCamera> cameras() override { return list_cameras(); }

    int open(const std::string& node) override {
        const int device = ::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        return device < 0 ? -errno : device;
    }

    void close(int device) override { ::close(device); }

    int control(int device, unsigned long request, void* argument) override {
        int result = 0;
        do {
            result = ::ioctl(device, request, argument);
        } while (result < 0 && errno == EINTR);
        return result < 0 ? errno : 0;
    }

    void* map(int device, std::size_t bytes, std::int64_t offset) override {
        void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, device, offset);
        return memory == MAP_FAILED ? nullptr : memory;
    }

    void unmap(void* memory, std::size_t bytes) override { ::munmap(memory, bytes); }

    Wakening wait(int device, Waker& waker, steady_clock::time_point deadline) override {
        pollfd watched[] = {{waker.descriptor(), POLLIN, 0}, {device, POLLIN, 0}};
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
        const int timeout = static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000));
        if (::poll(watched, device < 0 ? 1 : 2, timeout) <= 0) {
            return {};
        }
        Wakening wakening;
        wakening.woken = watched[0].revents != 0;
        if (wakening.woken) {
            waker.clear();
        }
        wakening.readable = (watched[1].revents & POLLIN) != 0;
        wakening.failed = (watched[1].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
        return wakening;
    }

    int reset_usb(int bus, int address) override { return reset_usb_device(bus, address); }

    steady_clock::time_point now() override { return steady_clock::now(); }

    std::int64_t realtime_ns() override {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    }
};

}  // namespace

VideoSystem& linux_video_system() {
    static LinuxVideoSystem system;
    return system;
}

std::string error_text(int code) {
    return std::generic_category().message(code);
}

}  // namespace disparityd::capture
