// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/camera/video_system.h"

struct v4l2_buffer;

namespace disparityd::capture {

/// Says why a V4L2 device cannot be used: what() has the call and the system's reason.
class VideoError : public std::runtime_error {
public:
    enum class Call { open, capabilities, format, buffers, stream };
    VideoError(Call which, int number, const std::string& what) : std::runtime_error(what), call(which), code(number) {}
    const Call call;
    const int code;  ///< errno; 0: the device works, but not as asked
};

struct StreamRequest {
    int width = 0;  ///< of the whole frame, pixels
    int height = 0;
    double rate = 0;
    std::uint32_t fourcc = 0;  ///< the driver's name of the format
    int bytes_per_pixel = 2;   ///< as it is sent; 0: each frame is a JPEG
    int loans = 8;             ///< frames that may be out at the same time
};

/// A captured buffer; the bytes lie in the driver's memory until give_back().
struct VideoFrame {
    const std::uint8_t* data = nullptr;
    std::size_t bytes = 0;  ///< as the driver counts them
    std::ptrdiff_t stride = 0;
    std::uint32_t sequence = 0;  ///< the driver's: 32 bits, from 0 at each start
    /// CLOCK_MONOTONIC at capture, however long the frame lay in the driver. Where the driver gives no time that can be
    /// right: when the frame was taken if that is exact to 0.1 s, else a moment before it came. Never newer than a time
    /// of the driver's that is of this clock and past.
    std::int64_t monotonic_ns = 0;
    int loan = -1;
    bool stamped = false;  ///< the time is the driver's, and at most 10 s before the stream's start
};

/// One V4L2 device that streams into memory-mapped buffers, which are lent as they are and go back to the driver when
/// the loan ends. One thread calls everything; give_back() may come from any, also after close(): memory that is
/// lent stays mapped until then.
class VideoStream {
public:
    VideoStream(VideoSystem& system, base::Waker& waker);
    ~VideoStream();
    VideoStream(const VideoStream&) = delete;
    VideoStream& operator=(const VideoStream&) = delete;

    /// Opens the node, agrees on a format and maps buffers. Throws VideoError; the node is closed then.
    void open(const std::string& node, const StreamRequest& request);

    /// Gives the driver every buffer that is not lent, and starts. Throws VideoError.
    void start();

    /// Stops the stream; buffers stay. What is lent stays lent.
    void stop() noexcept;

    /// Frees the device for others. Safe to call twice.
    void close() noexcept;

    bool is_open() const { return device_ >= 0; }

    enum class Got {
        frame,    ///< `frame` is a loan
        nothing,  ///< the deadline has passed
        woken,    ///< the waker was woken
        failed,   ///< the device has an error: failure() says which; close or restart it
    };
    /// Frames that are flagged as damaged or too short go back to the driver and are counted. So do, uncounted, those
    /// without a time that the driver may have had before start(): nobody knows how old they are. Allocates nothing.
    Got take(VideoFrame& frame, std::chrono::steady_clock::time_point deadline);

    void give_back(int loan) noexcept;

    /// Gives the driver what was given back; take() does it too.
    void collect() noexcept { take_returned(); }

    /// errno of the call that failed last.
    int failure() const { return failure_; }

    /// Frames per second as agreed on; 0 when the driver does not say.
    double rate() const { return rate_; }

    /// Returns how long a frame is exposed, as the driver reports it now; nothing where it does not, or cannot be
    /// right.
    std::optional<std::chrono::nanoseconds> exposure() const;

    std::uint64_t damaged() const { return damaged_.load(std::memory_order_relaxed); }
    std::uint64_t too_short() const { return too_short_.load(std::memory_order_relaxed); }

private:
    struct Buffer {
        void* memory = nullptr;
        std::size_t bytes = 0;
        bool lent = false;
        std::chrono::steady_clock::time_point queued;  ///< with the driver since then, empty
    };
    struct Orphan {
        int loan;
        void* memory;
        std::size_t bytes;
    };

    void check_capabilities();
    void agree_on_format(const StreamRequest& request);
    void agree_on_rate(double rate);
    void map_buffers(int count);
    [[noreturn]] void fail(VideoError::Call call, int code, const std::string& what) const;
    int enqueue(std::uint32_t index);
    int take_returned();
    void free_orphan(int loan);
    Got dequeue(VideoFrame& frame);
    std::optional<std::int64_t> capture_time(const v4l2_buffer& buffer) const;
    std::int64_t time_of_arrival(const Buffer& filled) const;

    VideoSystem& system_;
    base::Waker& waker_;
    std::string node_;
    int device_ = -1;
    std::uint32_t generation_ = 0;  ///< of the buffers; a loan carries it
    std::vector<Buffer> buffers_;
    std::vector<Orphan> orphans_;  ///< lent memory of devices that were closed
    int loans_ = 0;                ///< the most that may be out
    int lent_ = 0;
    bool streaming_ = false;
    bool timed_ = false;  ///< the newest frame of this stream is stamped
    std::chrono::steady_clock::time_point started_;
    std::chrono::steady_clock::time_point empty_at_;  ///< when the driver had no frame last
    std::size_t of_unknown_age_ = 0;                  ///< so many of the next frames may be of before the start
    std::size_t stride_ = 0;
    std::size_t frame_bytes_ = 0;
    double rate_ = 0;
    int failure_ = 0;
    std::atomic<std::uint64_t> damaged_{0};
    std::atomic<std::uint64_t> too_short_{0};

    std::mutex mutex_;           ///< the two below
    std::vector<int> returned_;  ///< loans that ended and are not with the driver yet
    bool starving_ = false;      ///< wake at the next return
};

}  // namespace disparityd::capture
