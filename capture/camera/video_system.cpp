// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/video_system.h"

#include <fstream>

#include <sys/mman.h>
#include <unistd.h>

#include "base/device_file.h"
#include "capture/usb/usb_reset.h"

namespace disparityd::capture {

namespace {

using std::chrono::steady_clock;

class LinuxVideoSystem final : public VideoSystem {
public:
    std::vector<UsbCamera> cameras() override { return list_cameras(); }

    int open(const std::string& node) override { return base::open_device(node); }
    void close(int device) override { ::close(device); }
    int ioctl(int device, unsigned long request, void* argument) override {
        return base::device_ioctl(device, request, argument);
    }

    void* map(int device, std::size_t bytes, std::int64_t offset) override {
        void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, device, offset);
        return memory == MAP_FAILED ? nullptr : memory;
    }

    void unmap(void* memory, std::size_t bytes) override { ::munmap(memory, bytes); }

    base::Wakening wait(int device, base::Waker& waker, steady_clock::time_point deadline) override {
        return base::wait_for_device(device, waker, deadline);
    }

    int reset_usb(int bus, int address) override { return reset_usb_device(bus, address); }

    steady_clock::time_point now() override { return steady_clock::now(); }

    std::int64_t realtime_ns() override {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    }

    bool stamps_begin_exposure() override {
        char answer = 0;
        return std::ifstream("/sys/module/uvcvideo/parameters/hwtimestamps") >> answer && answer != '0';
    }
};

}  // namespace

VideoSystem& linux_video_system() {
    static LinuxVideoSystem system;
    return system;
}

}  // namespace disparityd::capture
