// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera/video_system.h"

namespace disparityd::capture::test {

/// A V4L2 system with cameras that follow a script, and a clock of its own that runs only while somebody waits. A
/// camera sends a frame every period; its bytes are the number of the frame, modulo 256.
class FakeVideoSystem final : public VideoSystem {
public:
    /// A camera and how it behaves; tests change it at any time.
    struct Camera {
        UsbCamera usb;
        int width = 64;  ///< of the whole frame
        int height = 16;
        std::uint32_t format = 0x56595559;               ///< YUYV
        std::vector<std::vector<std::uint8_t>> jpegs{};  ///< sent in turn, for the format MJPG
        int open_error = 0;
        int format_error = 0;
        int buffers_error = 0;
        int buffers_most = 32;
        int queue_error = 0;
        int start_error = 0;
        int dequeue_error = 0;    ///< once
        bool frozen = false;      ///< sends nothing
        bool dead = false;        ///< sends nothing until the stream is started anew
        bool flag_stays = false;  ///< as nodrop=1: every frame comes flagged
        int heal_by = 0;          ///< a frozen camera thaws by: 1 stream start, 2 opening, 3 USB reset
        std::uint32_t first_sequence = 0;
        std::chrono::microseconds period{33'333};
        bool untold_rate = false;       ///< the driver does not say one
        std::uint32_t agreed_rate = 0;  ///< frames per second, whatever is asked for; 0: what is
        std::string flash_serial;       ///< digits; empty: no extension unit
        std::vector<std::uint8_t> unit_answer{};
        std::map<std::pair<std::uint8_t, std::uint32_t>, std::uint8_t> registers{};  ///< behind the unit, by part
        std::int32_t brightness = 4;                                                 ///< a control of V4L2, 0 .. 8
        std::int32_t exposure = 0;                                                   ///< in 100 us; 0: none is told
        bool old_clock = false;                                                      ///< stamps with another clock
        std::optional<std::int64_t> stamp_s{};                                       ///< in place of the true seconds
        std::chrono::microseconds stamp_ahead{0};                                    ///< is added to the true stamp
        /// Frames come so long after each multiple of the period, as those of cameras with a common trigger; else after
        /// the stream's start.
        std::optional<std::chrono::microseconds> trigger{};
        /// Writes the picture of a frame, in place of its number.
        std::function<void(std::uint32_t sequence, std::vector<std::uint8_t>& picture)> draw{};
    };
    struct Fault {
        bool flagged = false;
        std::uint32_t bytes = 0;  ///< used; of a fault
        int skip = 0;             ///< numbers left out before
        std::string node{};       ///< the camera; empty: whichever sends next
    };

    FakeVideoSystem();
    ~FakeVideoSystem() override;

    /// Plugs a camera in; a node may be there once.
    Camera& plug(const Camera& camera);
    void unplug(const std::string& node);
    Camera& camera(const std::string& node) { return cameras_.at(node); }

    /// The next frame comes with this fault.
    void fault(const Fault& fault) { faults_.push_back(fault); }
    /// What a STALL of the endpoint does: every queued buffer comes back flagged, empty, with sequence 0.
    void hand_back_all();

    void at(std::chrono::milliseconds after, std::function<void()> action) {
        script_.emplace(now_ + after, std::move(action));
    }
    void advance(std::chrono::milliseconds time) { run_until(now_ + time); }

    int open_devices() const { return static_cast<int>(devices_.size()); }
    int mapped() const { return static_cast<int>(mapped_.size()); }
    int waits() const { return waits_; }
    const std::vector<std::string>& calls() const { return calls_; }
    int count(const std::string& call) const;
    int reset_error = 0;

    std::vector<UsbCamera> cameras() override;
    int open(const std::string& node) override;
    void close(int device) override;
    int ioctl(int device, unsigned long request, void* argument) override;
    void* map(int device, std::size_t bytes, std::int64_t offset) override;
    void unmap(void* memory, std::size_t bytes) override;
    base::Wakening wait(int device, base::Waker& waker, std::chrono::steady_clock::time_point deadline) override;
    int reset_usb(int bus, int address) override;
    std::chrono::steady_clock::time_point now() override { return now_; }
    std::int64_t realtime_ns() override;
    bool stamps_begin_exposure() override { return begin_exposure; }
    bool begin_exposure = false;  ///< frames come when they are exposed, their stamps tell when that began

private:
    struct Filled {
        std::uint32_t index;
        std::uint32_t flags;
        std::uint32_t bytes;
        std::uint32_t sequence;
        std::chrono::steady_clock::time_point time;
    };
    struct Device {
        std::string node;
        bool gone = false;
        bool streaming = false;
        std::vector<std::vector<std::uint8_t>> memory;
        std::deque<std::uint32_t> queued;
        std::deque<Filled> done;
        std::uint32_t sequence = 0;
        std::chrono::steady_clock::time_point next_frame;
    };

    Camera* camera_of(const Device& device);
    void run_until(std::chrono::steady_clock::time_point time);
    void send_frames();
    void send_frame(Device& device, const Camera& camera);
    bool faulty(const Device& device) const;
    int start(Device& device, Camera& camera);
    int dequeue(Device& device, Camera& camera, void* argument);
    int request_buffers(Device& device, Camera& camera, void* argument);
    int enumerate(const Camera& camera, unsigned long request, void* argument) const;
    int control_value(Camera& camera, unsigned long request, void* argument);
    int ask_extension_unit(Camera& camera, void* argument);
    void answer_command(Camera& camera, const std::vector<std::uint8_t>& command);
    std::size_t frame_bytes(const Camera& camera) const;

    std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
    std::map<std::string, Camera> cameras_;
    std::map<int, Device> devices_;
    std::vector<std::vector<std::uint8_t>> orphaned_;  ///< memory of closed devices that is still mapped
    std::map<const void*, std::size_t> mapped_;
    std::multimap<std::chrono::steady_clock::time_point, std::function<void()>> script_;
    std::deque<Fault> faults_;
    std::vector<std::string> calls_;
    int next_device_ = 3;
    int waits_ = 0;
};

/// A ZED 2 that sends frames of 64 x 16.
FakeVideoSystem::Camera zed2(const std::string& node = "/dev/video0", const std::string& serial = "12345");

}  // namespace disparityd::capture::test
