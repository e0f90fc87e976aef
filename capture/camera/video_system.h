// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/waker.h"
#include "capture/usb/usb_camera.h"

namespace disparityd::capture {

/// What a live camera needs of the system, so that tests can put a scripted camera and a clock of their own in its
/// place. Errors are numbers of errno; nothing throws but cameras().
class VideoSystem {
public:
    virtual ~VideoSystem() = default;

    /// The cameras that are there now, in order of their nodes.
    virtual std::vector<UsbCamera> cameras() = 0;

    /// Returns a descriptor that never blocks, or -errno.
    virtual int open(const std::string& node) = 0;
    virtual void close(int device) = 0;

    /// As the system call, but returns 0 or errno, and is repeated when a signal interrupts it.
    virtual int ioctl(int device, unsigned long request, void* argument) = 0;

    /// Maps the memory of a buffer, or returns nullptr; it outlives close().
    virtual void* map(int device, std::size_t bytes, std::int64_t offset) = 0;
    virtual void unmap(void* memory, std::size_t bytes) = 0;

    /// Waits as base::wait_for_device(), by the clock of now().
    virtual base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) = 0;

    /// Resets a USB device as unplugging it would: 0 or errno. Takes up to some seconds.
    virtual int reset_usb(int bus, int address) = 0;

    virtual std::chrono::steady_clock::time_point now() = 0;
    virtual std::int64_t realtime_ns() = 0;

    /// Whether the driver's stamps are the camera's own, of the start of exposure (uvcvideo with hwtimestamps=1).
    /// Otherwise it stamps a frame when its first packet comes, which is after the exposure.
    virtual bool stamps_begin_exposure() { return false; }
};

/// Returns this machine's cameras; one object for all.
VideoSystem& linux_video_system();

}  // namespace disparityd::capture
