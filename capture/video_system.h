// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "capture/usb_camera.h"
#include "capture/waker.h"

namespace disparityd::capture {

/// What a live camera needs of the system, so that tests can put a scripted camera and a clock of their own in its
/// place. Errors are numbers of errno; nothing throws but cameras().
class VideoSystem {
public:
    virtual ~VideoSystem() = default;

    /// The cameras that are there now, in order of their nodes.
    virtual std::vector<UsbCamera> cameras() = 0;

    /// A descriptor that never blocks, or -errno.
    virtual int open(const std::string& node) = 0;
    virtual void close(int device) = 0;

    /// ioctl(): 0 or errno. Repeated when a signal interrupts it.
    virtual int control(int device, unsigned long request, void* argument) = 0;

    /// Shared memory of a buffer, or nullptr; it outlives close().
    virtual void* map(int device, std::size_t bytes, std::int64_t offset) = 0;
    virtual void unmap(void* memory, std::size_t bytes) = 0;

    struct Wakening {
        bool woken = false;     ///< by the waker, which is cleared
        bool readable = false;  ///< a buffer waits
        bool failed = false;    ///< the device has an error or is gone
    };
    /// Sleeps until the device has something to say, the waker is woken or the deadline passes. device -1: none.
    virtual Wakening wait(int device, Waker& waker, std::chrono::steady_clock::time_point deadline) = 0;

    /// Resets a USB device as unplugging it would: 0 or errno. Takes up to some seconds.
    virtual int reset_usb(int bus, int address) = 0;

    virtual std::chrono::steady_clock::time_point now() = 0;
    virtual std::int64_t realtime_ns() = 0;
};

/// This machine's; one object for all.
VideoSystem& linux_video_system();

/// What a number of errno stands for, such as "Device or resource busy".
std::string error_text(int code);

}  // namespace disparityd::capture
