// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/video_stream.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include <linux/videodev2.h>

#include "base/failure_text.h"

namespace disparityd::capture {

namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

/// So many buffers stay with the driver while the pipeline holds all its loans.
constexpr int spare_buffers = 4;
constexpr int most_buffers = VIDEO_MAX_FRAME;
constexpr int fewest_buffers = 3;

/// A frame without its driver's time has that of its taking where it is known to be no older than this.
constexpr std::chrono::milliseconds unsure{100};

/// A driver's time of longer before the stream's start is of an old frame or a wrong clock: nobody can tell which.
constexpr std::chrono::seconds longest_before_start{10};

std::int64_t ns_of(steady_clock::time_point time) {
    return nanoseconds(time.time_since_epoch()).count();
}

/// A loan has the number of the buffer in its low bits, above them the generation of the buffers.
constexpr std::uint32_t index_bits = 8;
constexpr std::uint32_t generation_mask = (1U << 22U) - 1;

std::string format_text(const v4l2_pix_format& format) {
    std::string letters;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const auto letter = static_cast<char>((format.pixelformat >> shift) & 0x7fU);
        letters += letter > ' ' ? letter : ' ';
    }
    return std::to_string(format.width) + "x" + std::to_string(format.height) + " " + letters;
}

v4l2_buffer mapped_buffer(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
}

}  // namespace

VideoStream::VideoStream(VideoSystem& system, base::Waker& waker) : system_(system), waker_(waker) {
    returned_.reserve(std::size_t{4} * most_buffers);
}

VideoStream::~VideoStream() {
    close();
    for (const Orphan& orphan : orphans_) {
        system_.unmap(orphan.memory, orphan.bytes);
    }
}

void VideoStream::fail(VideoError::Call call, int code, const std::string& what) const {
    throw VideoError(call, code, node_ + ": " + what + (code == 0 ? "" : ": " + base::error_text(code)));
}

void VideoStream::open(const std::string& node, const StreamRequest& request) {
    close();
    node_ = node;
    const int device = system_.open(node);
    if (device < 0) {
        fail(VideoError::Call::open, -device, "cannot be opened");
    }
    device_ = device;
    try {
        check_capabilities();
        agree_on_format(request);
        agree_on_rate(request.rate);
        map_buffers(std::min(request.loans + spare_buffers, most_buffers));
    } catch (const VideoError&) {
        close();
        throw;
    }
    loans_ = std::min(request.loans, static_cast<int>(buffers_.size()) - 2);
}

void VideoStream::check_capabilities() {
    v4l2_capability capability{};
    if (const int code = system_.ioctl(device_, VIDIOC_QUERYCAP, &capability); code != 0) {
        fail(VideoError::Call::capabilities, code, "does not answer as a video device");
    }
    const std::uint32_t has =
        (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
    constexpr std::uint32_t needed = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    if ((has & needed) != needed) {
        fail(VideoError::Call::capabilities, 0, "is no camera that streams");
    }
}

void VideoStream::agree_on_format(const StreamRequest& request) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_pix_format& pixels = format.fmt.pix;
    pixels.width = static_cast<std::uint32_t>(request.width);
    pixels.height = static_cast<std::uint32_t>(request.height);
    pixels.pixelformat = request.fourcc;
    pixels.field = V4L2_FIELD_NONE;
    const v4l2_pix_format asked = pixels;
    if (const int code = system_.ioctl(device_, VIDIOC_S_FMT, &format); code != 0) {
        fail(VideoError::Call::format, code, "refuses " + format_text(asked));
    }
    if (pixels.width != asked.width || pixels.height != asked.height || pixels.pixelformat != asked.pixelformat) {
        fail(VideoError::Call::format, 0,
             "does not offer " + format_text(asked) + ", nearest is " + format_text(pixels));
    }
    const std::size_t row = std::size_t{pixels.width} * static_cast<std::size_t>(request.bytes_per_pixel);
    if (request.bytes_per_pixel == 0) {
        stride_ = 0;
        frame_bytes_ = 1;
        return;
    }
    stride_ = std::max<std::size_t>(pixels.bytesperline, row);
    frame_bytes_ = stride_ * (pixels.height - 1) + row;
}

void VideoStream::agree_on_rate(double rate) {
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_fract& interval = parameters.parm.capture.timeperframe;
    interval.numerator = 1000;
    interval.denominator = static_cast<std::uint32_t>(std::lround(rate * 1000));
    rate_ = 0;
    // A driver with only one rate may refuse the question.
    if (system_.ioctl(device_, VIDIOC_S_PARM, &parameters) == 0 && interval.numerator > 0) {
        rate_ = static_cast<double>(interval.denominator) / interval.numerator;
    }
}

void VideoStream::map_buffers(int count) {
    v4l2_requestbuffers wanted{};
    wanted.count = static_cast<std::uint32_t>(count);
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    if (const int code = system_.ioctl(device_, VIDIOC_REQBUFS, &wanted); code != 0) {
        fail(VideoError::Call::buffers, code, "gives no buffers");
    }
    if (wanted.count < fewest_buffers) {
        fail(VideoError::Call::buffers, ENOMEM, "gives only " + std::to_string(wanted.count) + " buffers");
    }
    generation_ = (generation_ + 1) & generation_mask;
    for (std::uint32_t index = 0; index < std::min<std::uint32_t>(wanted.count, most_buffers); ++index) {
        v4l2_buffer buffer = mapped_buffer(index);
        if (const int code = system_.ioctl(device_, VIDIOC_QUERYBUF, &buffer); code != 0) {
            fail(VideoError::Call::buffers, code, "does not say where its buffers are");
        }
        void* memory = system_.map(device_, buffer.length, buffer.m.offset);
        if (memory == nullptr) {
            fail(VideoError::Call::buffers, ENOMEM, "a buffer cannot be mapped");
        }
        buffers_.push_back({memory, buffer.length, false, {}});
        if (buffer.length < frame_bytes_) {
            fail(VideoError::Call::buffers, 0, "has buffers smaller than its frames");
        }
    }
}

void VideoStream::start() {
    started_ = system_.now();
    timed_ = false;
    of_unknown_age_ = buffers_.size();
    failure_ = take_returned();
    for (std::uint32_t index = 0; failure_ == 0 && index < buffers_.size(); ++index) {
        if (!buffers_[index].lent) {
            failure_ = enqueue(index);
        }
    }
    if (failure_ != 0) {
        fail(VideoError::Call::stream, failure_, "takes no buffers");
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    failure_ = system_.ioctl(device_, VIDIOC_STREAMON, &type);
    if (failure_ != 0) {
        fail(VideoError::Call::stream, failure_, "does not start");
    }
    streaming_ = true;
}

void VideoStream::stop() noexcept {
    if (device_ < 0) {
        return;
    }
    // Stops after a failed start, too: that takes the buffers back from the driver.
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    system_.ioctl(device_, VIDIOC_STREAMOFF, &type);
    streaming_ = false;
}

void VideoStream::close() noexcept {
    if (device_ < 0) {
        return;
    }
    stop();
    take_returned();
    for (std::size_t index = 0; index < buffers_.size(); ++index) {
        const Buffer& buffer = buffers_[index];
        if (buffer.lent) {
            orphans_.push_back({static_cast<int>((generation_ << index_bits) | static_cast<std::uint32_t>(index)),
                                buffer.memory, buffer.bytes});
        } else {
            system_.unmap(buffer.memory, buffer.bytes);
        }
    }
    // Lent memory keeps the device's file open, and with it the right to stream: give that back first.
    v4l2_requestbuffers none{};
    none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    none.memory = V4L2_MEMORY_MMAP;
    system_.ioctl(device_, VIDIOC_REQBUFS, &none);
    buffers_.clear();
    lent_ = 0;
    system_.close(device_);
    device_ = -1;
    const std::lock_guard lock(mutex_);
    starving_ = !orphans_.empty();
}

int VideoStream::enqueue(std::uint32_t index) {
    buffers_[index].queued = system_.now();
    v4l2_buffer buffer = mapped_buffer(index);
    return system_.ioctl(device_, VIDIOC_QBUF, &buffer);
}

void VideoStream::free_orphan(int loan) {
    const auto orphan =
        std::find_if(orphans_.begin(), orphans_.end(), [loan](const Orphan& o) { return o.loan == loan; });
    if (orphan != orphans_.end()) {
        system_.unmap(orphan->memory, orphan->bytes);
        orphans_.erase(orphan);
    }
}

/// Gives the driver what came back since. Returns 0 or errno.
int VideoStream::take_returned() {
    int code = 0;
    const std::lock_guard lock(mutex_);
    for (const int loan : returned_) {
        const auto number = static_cast<std::uint32_t>(loan);
        const std::uint32_t index = number & ((1U << index_bits) - 1);
        if (number >> index_bits != generation_ || index >= buffers_.size()) {
            free_orphan(loan);
            continue;
        }
        if (std::exchange(buffers_[index].lent, false)) {
            --lent_;
            code = streaming_ && code == 0 ? enqueue(index) : code;
        }
    }
    returned_.clear();
    starving_ = lent_ >= loans_ || !orphans_.empty();
    return code;
}

void VideoStream::give_back(int loan) noexcept {
    bool wake = false;
    {
        const std::lock_guard lock(mutex_);
        returned_.push_back(loan);
        wake = starving_;
    }
    if (wake) {
        waker_.wake();
    }
}

VideoStream::Got VideoStream::take(VideoFrame& frame, steady_clock::time_point deadline) {
    for (;;) {
        failure_ = take_returned();
        if (failure_ != 0) {
            return Got::failed;
        }
        const bool all_lent = lent_ >= loans_;
        if (!all_lent) {
            const Got got = dequeue(frame);
            if (got != Got::nothing) {
                return got;
            }
        }
        if (system_.now() >= deadline) {
            return Got::nothing;
        }
        // Frames without the driver's time are waited for in short turns, so that it is known how old they can be.
        const auto turn = all_lent || timed_ ? deadline : std::min(deadline, system_.now() + unsure / 2);
        const auto wakening = system_.wait(all_lent ? -1 : device_, waker_, turn);
        if (wakening.woken) {
            return Got::woken;
        }
        if (wakening.failed && !wakening.readable) {
            // The next call says why. A device that reports an error here but not there counts as broken.
            const Got got = dequeue(frame);
            failure_ = got == Got::nothing ? EIO : failure_;
            return got == Got::nothing ? Got::failed : got;
        }
    }
}

/// Takes the next good frame that waits. Damaged ones go back, at most as many as there are buffers.
VideoStream::Got VideoStream::dequeue(VideoFrame& frame) {
    for (std::size_t tries = 0; tries < buffers_.size(); ++tries) {
        v4l2_buffer buffer = mapped_buffer(0);
        const auto asked = system_.now();
        failure_ = system_.ioctl(device_, VIDIOC_DQBUF, &buffer);
        if (failure_ == EAGAIN) {
            failure_ = 0;
            empty_at_ = asked;
            of_unknown_age_ = 0;
            return Got::nothing;
        }
        if (failure_ == 0 && buffer.index >= buffers_.size()) {
            failure_ = EIO;
        }
        if (failure_ != 0) {
            return Got::failed;
        }
        const bool damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
        const bool too_short = buffer.bytesused < frame_bytes_;
        const bool of_unknown_age = of_unknown_age_ > 0;
        of_unknown_age_ -= of_unknown_age ? 1 : 0;
        const auto stamp = capture_time(buffer);
        if (!damaged && !too_short && (stamp || !of_unknown_age)) {
            const Buffer& filled = buffers_[buffer.index];
            timed_ = stamp && *stamp >= ns_of(started_ - longest_before_start);
            frame = {static_cast<const std::uint8_t*>(filled.memory),
                     std::min<std::size_t>(buffer.bytesused, filled.bytes),
                     static_cast<std::ptrdiff_t>(stride_),
                     buffer.sequence,
                     stamp ? *stamp : time_of_arrival(filled),
                     static_cast<int>((generation_ << index_bits) | buffer.index),
                     timed_};
            buffers_[buffer.index].lent = true;
            ++lent_;
            return Got::frame;
        }
        if (damaged || too_short) {
            (damaged ? damaged_ : too_short_).fetch_add(1, std::memory_order_relaxed);
        }
        failure_ = enqueue(buffer.index);
        if (failure_ != 0) {
            return Got::failed;
        }
    }
    return Got::nothing;
}

/// Returns the driver's time where it is of CLOCK_MONOTONIC and not to come. It may be of any age: a device
/// that a program feeds has frames of before the stream's start.
std::optional<std::int64_t> VideoStream::capture_time(const v4l2_buffer& buffer) const {
    constexpr std::int64_t second = 1'000'000'000;
    const std::int64_t now = ns_of(system_.now());
    const bool our_clock = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    // Seconds are compared first: those of a wrong clock may be too many to be counted in nanoseconds.
    const std::int64_t stamp_s = buffer.timestamp.tv_sec;
    const std::int64_t stamp_us = buffer.timestamp.tv_usec;
    const bool countable = stamp_s >= 0 && stamp_s <= now / second + 1 && stamp_us >= 0 && stamp_us < second / 1000;
    const std::int64_t stamp = countable ? stamp_s * second + stamp_us * 1000 : 0;
    if (!our_clock || stamp == 0 || stamp > now + nanoseconds(unsure).count()) {
        return std::nullopt;
    }
    return std::min(now, stamp);
}

/// Returns when a frame without its driver's time came: now where it cannot have lain for long, else the last moment
/// at which it was not there yet. So it may look older than it is, but an old one never looks new.
std::int64_t VideoStream::time_of_arrival(const Buffer& filled) const {
    const auto now = system_.now();
    const auto not_yet = std::max(empty_at_, filled.queued);
    return ns_of(now - not_yet <= unsure ? now : not_yet);
}

std::optional<nanoseconds> VideoStream::exposure() const {
    constexpr std::chrono::microseconds unit{100};
    constexpr std::int32_t most = 100'000;  // 10 s
    v4l2_control control{};
    control.id = V4L2_CID_EXPOSURE_ABSOLUTE;
    if (system_.ioctl(device_, VIDIOC_G_CTRL, &control) != 0 || control.value <= 0 || control.value > most) {
        return std::nullopt;
    }
    return control.value * unit;
}

}  // namespace disparityd::capture
