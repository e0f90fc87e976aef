// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/guest/video_reader.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

namespace vm_guest {

namespace {

constexpr std::uint32_t buffer_count = 4;

void call(int device, unsigned long request, void* argument, const char* name) {
    while (::ioctl(device, request, argument) != 0) {
        if (errno != EINTR) {
            throw std::system_error(errno, std::generic_category(), name);
        }
    }
}

v4l2_buffer mapped_buffer(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
}

}  // namespace

VideoReader::VideoReader(const std::string& node, Size size)
    : device_(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
    if (!device_) {
        throw std::system_error(errno, std::generic_category(), node);
    }
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = size.width;
    format.fmt.pix.height = size.height;
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
    call(device_.get(), VIDIOC_S_FMT, &format, "VIDIOC_S_FMT");
    if (format.fmt.pix.width != size.width || format.fmt.pix.height != size.height ||
        format.fmt.pix.pixelformat != V4L2_PIX_FMT_YUYV) {
        throw std::runtime_error(node + " gives frames of another size");
    }
    v4l2_streamparm rate{};
    rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    rate.parm.capture.timeperframe = {1, 15};
    call(device_.get(), VIDIOC_S_PARM, &rate, "VIDIOC_S_PARM");
}

VideoReader::~VideoReader() {
    for (const auto& each : buffers_) {
        ::munmap(each.data(), each.size());
    }
}

std::vector<VideoReader::Size> VideoReader::sizes() const {
    std::vector<Size> found;
    v4l2_frmsizeenum size{};
    size.pixel_format = V4L2_PIX_FMT_YUYV;
    while (::ioctl(device_.get(), VIDIOC_ENUM_FRAMESIZES, &size) == 0) {
        found.push_back({size.discrete.width, size.discrete.height});
        ++size.index;
    }
    return found;
}

void VideoReader::queue(std::uint32_t index) {
    v4l2_buffer buffer = mapped_buffer(index);
    call(device_.get(), VIDIOC_QBUF, &buffer, "VIDIOC_QBUF");
}

void VideoReader::start() {
    if (buffers_.empty()) {
        v4l2_requestbuffers request{};
        request.count = buffer_count;
        request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        request.memory = V4L2_MEMORY_MMAP;
        call(device_.get(), VIDIOC_REQBUFS, &request, "VIDIOC_REQBUFS");
        for (std::uint32_t i = 0; i < request.count; ++i) {
            v4l2_buffer buffer = mapped_buffer(i);
            call(device_.get(), VIDIOC_QUERYBUF, &buffer, "VIDIOC_QUERYBUF");
            void* memory = ::mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, device_.get(), buffer.m.offset);
            if (memory == MAP_FAILED) {
                throw std::system_error(errno, std::generic_category(), "mmap");
            }
            buffers_.push_back({static_cast<std::uint8_t*>(memory), buffer.length});
        }
    }
    for (std::uint32_t i = 0; i < buffers_.size(); ++i) {
        queue(i);
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    call(device_.get(), VIDIOC_STREAMON, &type, "VIDIOC_STREAMON");
}

void VideoReader::stop() {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    call(device_.get(), VIDIOC_STREAMOFF, &type, "VIDIOC_STREAMOFF");
}

bool VideoReader::read(Frame& frame, milliseconds limit) {
    pollfd ready{device_.get(), POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(limit.count())) == 0) {
        return false;
    }
    v4l2_buffer buffer = mapped_buffer(0);
    call(device_.get(), VIDIOC_DQBUF, &buffer, "VIDIOC_DQBUF");
    const std::span<std::uint8_t> filled = buffers_.at(buffer.index).first(buffer.bytesused);
    frame.bytes.assign(filled.begin(), filled.end());
    frame.sequence = buffer.sequence;
    frame.flags = buffer.flags;
    queue(buffer.index);
    return true;
}

}  // namespace vm_guest
