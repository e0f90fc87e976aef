// SPDX-License-Identifier: Apache-2.0
#include "tests/capture/camera/fake_camera.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <gtest/gtest.h>
#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>
#include <poll.h>

namespace disparityd::capture::test {

namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

/// Bytes of a pixel, and room for JPEGs.
unsigned bytes_of(std::uint32_t format) {
    const bool bayer = format == V4L2_PIX_FMT_SBGGR8 || format == V4L2_PIX_FMT_SGBRG8 ||
                       format == V4L2_PIX_FMT_SGRBG8 || format == V4L2_PIX_FMT_SRGGB8;
    return format == V4L2_PIX_FMT_GREY || bayer ? 1 : format == V4L2_PIX_FMT_Y12I ? 3 : 2;
}

v4l2_buffer& as_buffer(void* argument) {
    return *static_cast<v4l2_buffer*>(argument);
}

}  // namespace

FakeVideoSystem::FakeVideoSystem() = default;
FakeVideoSystem::~FakeVideoSystem() = default;

FakeVideoSystem::Camera& FakeVideoSystem::plug(const Camera& camera) {
    return cameras_[camera.usb.node] = camera;
}

void FakeVideoSystem::unplug(const std::string& node) {
    cameras_.erase(node);
    for (auto& [_, device] : devices_) {
        device.gone = device.gone || device.node == node;
    }
}

void FakeVideoSystem::hand_back_all() {
    for (auto& [_, device] : devices_) {
        for (; !device.queued.empty(); device.queued.pop_front()) {
            device.done.push_back({device.queued.front(), V4L2_BUF_FLAG_ERROR, 0, 0, {}});
        }
    }
}

int FakeVideoSystem::count(const std::string& call) const {
    return static_cast<int>(std::count(calls_.begin(), calls_.end(), call));
}

std::vector<UsbCamera> FakeVideoSystem::cameras() {
    std::vector<UsbCamera> list;
    for (const auto& [_, camera] : cameras_) {
        list.push_back(camera.usb);
    }
    return list;
}

FakeVideoSystem::Camera* FakeVideoSystem::camera_of(const Device& device) {
    const auto found = cameras_.find(device.node);
    return device.gone || found == cameras_.end() ? nullptr : &found->second;
}

std::size_t FakeVideoSystem::frame_bytes(const Camera& camera) const {
    const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    return pixels * bytes_of(camera.format);
}

int FakeVideoSystem::open(const std::string& node) {
    calls_.push_back("open " + node);
    const auto found = cameras_.find(node);
    if (found == cameras_.end()) {
        return -ENOENT;
    }
    if (found->second.open_error != 0) {
        return -found->second.open_error;
    }
    if (found->second.heal_by == 2) {
        found->second.frozen = false;
    }
    devices_[next_device_].node = node;
    return next_device_++;
}

void FakeVideoSystem::close(int device) {
    for (auto& memory : devices_.at(device).memory) {
        if (mapped_.contains(memory.data())) {
            orphaned_.push_back(std::move(memory));
        }
    }
    devices_.erase(device);
}

void* FakeVideoSystem::map(int device, std::size_t bytes, std::int64_t offset) {
    auto& memory = devices_.at(device).memory.at(static_cast<std::size_t>(offset));
    EXPECT_EQ(memory.size(), bytes);
    mapped_[memory.data()] = bytes;
    return memory.data();
}

void FakeVideoSystem::unmap(void* memory, std::size_t bytes) {
    const auto found = mapped_.find(memory);
    ASSERT_NE(found, mapped_.end()) << "unmapped twice";
    EXPECT_EQ(found->second, bytes);
    mapped_.erase(found);
    std::erase_if(orphaned_, [memory](const auto& orphan) { return orphan.data() == memory; });
}

int FakeVideoSystem::ioctl(int number, unsigned long request, void* argument) {
    Device& device = devices_.at(number);
    Camera* camera = camera_of(device);
    if (camera == nullptr) {
        // What uvcvideo does at unplug: the stream is off already, and the file's other calls have no device.
        return request == VIDIOC_DQBUF ? EINVAL : ENODEV;
    }
    switch (request) {
        case VIDIOC_QUERYCAP: {
            auto& capability = *static_cast<v4l2_capability*>(argument);
            capability.capabilities = V4L2_CAP_DEVICE_CAPS;
            capability.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
            return 0;
        }
        case VIDIOC_S_FMT: {
            auto& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
            pixels.width = static_cast<std::uint32_t>(camera->width);
            pixels.height = static_cast<std::uint32_t>(camera->height);
            pixels.pixelformat = camera->format;
            pixels.bytesperline = pixels.width * bytes_of(camera->format);
            return camera->format_error;
        }
        case VIDIOC_S_PARM:
            if (camera->untold_rate) {
                return ENOTTY;
            }
            if (camera->agreed_rate != 0) {
                static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe = {1, camera->agreed_rate};
            }
            return 0;
        case VIDIOC_REQBUFS: return request_buffers(device, *camera, argument);
        case VIDIOC_QUERYBUF: {
            v4l2_buffer& buffer = as_buffer(argument);
            buffer.length = static_cast<std::uint32_t>(frame_bytes(*camera));
            buffer.m.offset = buffer.index;
            return 0;
        }
        case VIDIOC_QBUF:
            if (camera->queue_error != 0) {
                return camera->queue_error;
            }
            EXPECT_EQ(std::count(device.queued.begin(), device.queued.end(), as_buffer(argument).index), 0)
                << "queued twice";
            device.queued.push_back(as_buffer(argument).index);
            return 0;
        case VIDIOC_DQBUF: return dequeue(device, *camera, argument);
        case VIDIOC_STREAMON: return start(device, *camera);
        case VIDIOC_STREAMOFF:
            calls_.emplace_back("stop");
            device.streaming = false;
            device.queued.clear();
            device.done.clear();
            return 0;
        case UVCIOC_CTRL_QUERY: return ask_extension_unit(*camera, argument);
        case VIDIOC_QUERYCTRL:
        case VIDIOC_G_CTRL:
        case VIDIOC_S_CTRL: return control_value(*camera, request, argument);
        default: return enumerate(*camera, request, argument);
    }
}

/// One format, of one size, at one rate.
int FakeVideoSystem::enumerate(const Camera& camera, unsigned long request, void* argument) const {
    if (request == VIDIOC_ENUM_FMT) {
        auto& format = *static_cast<v4l2_fmtdesc*>(argument);
        format.pixelformat = camera.format;
        return format.index == 0 ? 0 : EINVAL;
    }
    if (request == VIDIOC_ENUM_FRAMESIZES) {
        auto& size = *static_cast<v4l2_frmsizeenum*>(argument);
        size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        size.discrete = {static_cast<std::uint32_t>(camera.width), static_cast<std::uint32_t>(camera.height)};
        return size.index == 0 && size.pixel_format == camera.format ? 0 : EINVAL;
    }
    if (request == VIDIOC_ENUM_FRAMEINTERVALS) {
        auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
        interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        interval.discrete = {static_cast<std::uint32_t>(camera.period.count()), 1'000'000};
        return interval.index == 0 ? 0 : EINVAL;
    }
    return ENOTTY;
}

int FakeVideoSystem::control_value(Camera& camera, unsigned long request, void* argument) {
    if (request == VIDIOC_QUERYCTRL) {
        auto& query = *static_cast<v4l2_queryctrl*>(argument);
        if (query.id != V4L2_CTRL_FLAG_NEXT_CTRL) {
            return EINVAL;
        }
        query = {};
        query.id = V4L2_CID_BRIGHTNESS;
        query.type = V4L2_CTRL_TYPE_INTEGER;
        query.maximum = 8;
        query.default_value = 4;
        const std::string name = "Brightness (Auto)";
        std::copy(name.begin(), name.end(), query.name);
        return 0;
    }
    auto& value = *static_cast<v4l2_control*>(argument);
    if (value.id == V4L2_CID_EXPOSURE_ABSOLUTE && request == VIDIOC_G_CTRL) {
        calls_.emplace_back("exposure");
        value.value = camera.exposure;
        return camera.exposure != 0 ? 0 : EINVAL;
    }
    if (request == VIDIOC_S_CTRL) {
        camera.brightness = value.value;
    }
    value.value = camera.brightness;
    return value.id == V4L2_CID_BRIGHTNESS ? 0 : EINVAL;
}

/// A ZED's extension unit as far as serial number and registers go.
int FakeVideoSystem::ask_extension_unit(Camera& camera, void* argument) {
    auto& query = *static_cast<uvc_xu_control_query*>(argument);
    if (camera.flash_serial.empty() || query.unit != 4 || query.selector != 2) {
        return ENOENT;
    }
    if (query.query == UVC_GET_LEN) {
        EXPECT_EQ(query.size, 2);
        query.data[0] = 0x80;
        query.data[1] = 0x01;
        return 0;
    }
    EXPECT_EQ(query.size, 384);
    if (query.query == UVC_SET_CUR) {
        answer_command(camera, std::vector<std::uint8_t>(query.data, query.data + query.size));
        return 0;
    }
    std::copy(camera.unit_answer.begin(), camera.unit_answer.end(), query.data);
    return camera.unit_answer.empty() ? EIO : 0;
}

int FakeVideoSystem::request_buffers(Device& device, Camera& camera, void* argument) {
    auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
    if (wanted.count == 0) {
        return 0;
    }
    if (camera.buffers_error != 0) {
        return camera.buffers_error;
    }
    wanted.count = std::min(wanted.count, static_cast<std::uint32_t>(camera.buffers_most));
    device.memory.assign(wanted.count, std::vector<std::uint8_t>(frame_bytes(camera)));
    return 0;
}

int FakeVideoSystem::start(Device& device, Camera& camera) {
    calls_.emplace_back("start");
    if (camera.start_error != 0) {
        return camera.start_error;
    }
    camera.dead = false;
    camera.frozen = camera.frozen && camera.heal_by != 1;
    device.streaming = true;
    device.sequence = camera.first_sequence;
    device.next_frame = now_ + camera.period;
    if (camera.trigger) {
        device.next_frame -= device.next_frame.time_since_epoch() % camera.period - *camera.trigger;
    }
    return 0;
}

int FakeVideoSystem::dequeue(Device& device, Camera& camera, void* argument) {
    if (camera.dequeue_error != 0) {
        return std::exchange(camera.dequeue_error, 0);
    }
    if (!device.streaming) {
        return EINVAL;
    }
    if (device.done.empty()) {
        return EAGAIN;
    }
    const Filled filled = device.done.front();
    device.done.pop_front();
    v4l2_buffer& buffer = as_buffer(argument);
    buffer.index = filled.index;
    buffer.flags = filled.flags | (camera.old_clock ? 0U : static_cast<unsigned>(V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC));
    buffer.bytesused = filled.bytes;
    buffer.sequence = filled.sequence;
    const auto begun = begin_exposure ? filled.time - camera.exposure * std::chrono::microseconds(100) : filled.time;
    const auto stamp = nanoseconds(begun.time_since_epoch() + camera.stamp_ahead).count();
    buffer.timestamp.tv_sec = camera.stamp_s.value_or(stamp / 1'000'000'000);
    buffer.timestamp.tv_usec = stamp % 1'000'000'000 / 1000;
    return 0;
}

bool FakeVideoSystem::faulty(const Device& device) const {
    return !faults_.empty() && (faults_.front().node.empty() || faults_.front().node == device.node);
}

void FakeVideoSystem::send_frame(Device& device, const Camera& camera) {
    Fault fault;
    fault.bytes = static_cast<std::uint32_t>(frame_bytes(camera));
    if (faulty(device)) {
        fault = faults_.front();
        faults_.pop_front();
    }
    device.sequence += static_cast<std::uint32_t>(fault.skip);
    const std::uint32_t sequence = device.sequence++;
    if (device.queued.empty()) {
        return;  // nobody has room: lost, and seen by the number
    }
    const std::uint32_t index = device.queued.front();
    device.queued.pop_front();
    if (camera.draw) {
        camera.draw(sequence, device.memory[index]);
    } else {
        std::fill(device.memory[index].begin(), device.memory[index].end(), static_cast<std::uint8_t>(sequence));
    }
    if (!camera.jpegs.empty()) {
        const auto& jpeg = camera.jpegs[sequence % camera.jpegs.size()];
        std::copy(jpeg.begin(), jpeg.end(), device.memory[index].begin());
        fault.bytes = std::min(fault.bytes, static_cast<std::uint32_t>(jpeg.size()));
    }
    const bool flagged = fault.flagged || camera.flag_stays;
    device.done.push_back({index, flagged ? static_cast<std::uint32_t>(V4L2_BUF_FLAG_ERROR) : 0U, fault.bytes, sequence,
                           device.next_frame});
}

void FakeVideoSystem::send_frames() {
    for (auto& [_, device] : devices_) {
        const Camera* camera = camera_of(device);
        for (; camera != nullptr && device.streaming && device.next_frame <= now_;
             device.next_frame += camera->period) {
            if (!camera->frozen && !camera->dead) {
                send_frame(device, *camera);
            }
        }
    }
}

void FakeVideoSystem::run_until(steady_clock::time_point time) {
    now_ = std::max(now_, time);
    send_frames();
    while (!script_.empty() && script_.begin()->first <= now_) {
        const auto action = std::move(script_.begin()->second);
        script_.erase(script_.begin());
        action();
    }
}

void FakeVideoSystem::answer_command(Camera& camera, const std::vector<std::uint8_t>& command) {
    const std::uint8_t part = command[1];
    if (part == 0xa1) {
        EXPECT_EQ(std::vector<std::uint8_t>(command.begin(), command.begin() + 17),
                  (std::vector<std::uint8_t>{0x51, 0xa1, 3, 0, 0, 0, 1, 0x80, 0, 0x90, 64, 0, 64, 0, 0, 0, 0}));
        const std::string digits = std::string(8 - camera.flash_serial.size(), '0') + camera.flash_serial;
        camera.unit_answer.assign(384, 0xff);
        camera.unit_answer[17] = 'O';
        camera.unit_answer[18] = 'V';
        for (std::size_t i = 0; i < 4; ++i) {
            camera.unit_answer[19 + i] = static_cast<std::uint8_t>(std::stoi(digits.substr(2 * i, 2), nullptr, 16));
        }
        return;
    }
    const std::vector<std::uint8_t> shape(command.begin() + 2, command.begin() + 5);
    const std::vector<std::uint8_t> lengths(command.begin() + 9, command.begin() + 13);
    EXPECT_EQ(shape, part == 0xa2 ? (std::vector<std::uint8_t>{0, 4, 1}) : (std::vector<std::uint8_t>{0x6c, 2, 1}));
    EXPECT_EQ(lengths,
              part == 0xa2 ? (std::vector<std::uint8_t>{0, 1, 0, 1}) : (std::vector<std::uint8_t>{0x90, 1, 0, 1}));
    std::uint32_t address = 0;
    for (std::size_t i = 5; i < 9; ++i) {
        address = (address << 8U) | command[i];
    }
    if (command[0] == 0x50) {
        camera.registers[{part, address}] = command[16];
    } else {
        camera.unit_answer.assign(384, 0);
        camera.unit_answer[17] = camera.registers[{part, address}];
    }
}

base::Wakening FakeVideoSystem::wait(int number, base::Waker& waker, steady_clock::time_point deadline) {
    ++waits_;
    for (;;) {
        pollfd woken{waker.descriptor(), POLLIN, 0};
        base::Wakening wakening;
        wakening.woken = ::poll(&woken, 1, 0) > 0;
        if (wakening.woken) {
            waker.clear();
        }
        if (number >= 0) {
            const Device& device = devices_.at(number);
            wakening.failed = camera_of(device) == nullptr || !device.streaming;
            wakening.readable = !device.done.empty();
        }
        if (wakening.woken || wakening.readable || wakening.failed || now_ >= deadline) {
            return wakening;
        }
        auto next = deadline;
        for (const auto& [_, device] : devices_) {
            next = device.streaming && !device.gone ? std::min(next, device.next_frame) : next;
        }
        next = script_.empty() ? next : std::min(next, script_.begin()->first);
        run_until(next);
    }
}

int FakeVideoSystem::reset_usb(int bus, int address) {
    calls_.push_back("reset " + std::to_string(bus) + ":" + std::to_string(address));
    for (auto& [_, camera] : cameras_) {
        if (camera.usb.bus == bus && camera.usb.address == address && camera.heal_by == 3) {
            camera.frozen = false;
        }
    }
    return reset_error;
}

std::int64_t FakeVideoSystem::realtime_ns() {
    return nanoseconds(now_.time_since_epoch()).count() + 1'700'000'000'000'000'000;
}

FakeVideoSystem::Camera zed2(const std::string& node, const std::string& serial) {
    FakeVideoSystem::Camera camera;
    camera.usb.node = node;
    camera.usb.name = "ZED 2: ZED 2";
    camera.usb.port = "2-1";
    camera.usb.vendor = zed_vendor;
    camera.usb.product = 0xf780;
    camera.usb.firmware = 0x0142;
    camera.usb.serial = serial;
    camera.usb.speed_mbit = 5000;
    camera.usb.bus = 2;
    camera.usb.address = 5;
    return camera;
}

}  // namespace disparityd::capture::test
