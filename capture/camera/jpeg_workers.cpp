// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/jpeg_workers.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/start_thread.h"

namespace disparityd::capture {

namespace {

std::size_t frame_bytes(const EyeLayout& layout) {
    return std::size_t{4} * static_cast<std::size_t>(layout.eye_width) * static_cast<std::size_t>(layout.eye_height);
}

}  // namespace

JpegWorkers::JpegWorkers(const EyeLayout& layout, int threads, int loans, VideoStream& stream, base::Waker& waker)
    : loans_(std::max(1, loans)),
      stream_(stream),
      waker_(waker),
      frames_(static_cast<std::size_t>(loans_ + threads + 1), std::vector<std::uint8_t>(frame_bytes(layout))),
      jpeg_loans_(frames_.size(), -1),
      free_(frames_.size()),
      jobs_(frames_.size()) {
    for (int i = 0; i < std::max(1, threads); ++i) {
        decoders_.push_back(std::make_unique<JpegDecoder>(layout));
    }
    try {
        for (int i = 0; i < threads; ++i) {
            JpegDecoder& decoder = *decoders_[static_cast<std::size_t>(i)];
            threads_.push_back(base::start_thread([this, &decoder] { work(decoder); }));
        }
    } catch (...) {
        end();
        throw;
    }
}

JpegWorkers::~JpegWorkers() {
    end();
}

void JpegWorkers::end() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

bool JpegWorkers::has_room() {
    const std::lock_guard lock(mutex_);
    return free_.has_free();
}

bool JpegWorkers::busy() {
    const std::lock_guard lock(mutex_);
    return taken_ < submitted_;
}

void JpegWorkers::submit(const VideoFrame& jpeg) {
    std::unique_lock lock(mutex_);
    Job& next = job(submitted_++);
    next = {jpeg, static_cast<int>(free_.take()), false, {}};
    if (threads_.empty()) {
        ++begun_;
        decode(*decoders_.front(), next);
        next.done = true;
    }
    lock.unlock();
    changed_.notify_all();
}

void JpegWorkers::work(JpegDecoder& decoder) {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || begun_ < submitted_; });
        if (ending_) {
            return;
        }
        Job& next = job(begun_++);
        lock.unlock();
        decode(decoder, next);
        lock.lock();
        next.done = true;
        changed_.notify_all();
        waker_.wake();
    }
}

void JpegWorkers::decode(JpegDecoder& decoder, Job& job) {
    const char* problem =
        decoder.decode({job.jpeg.data, job.jpeg.bytes}, frames_[static_cast<std::size_t>(job.slot)].data());
    job.problem = problem == nullptr ? "" : problem;
}

std::optional<JpegWorkers::Decoded> JpegWorkers::take() {
    const std::lock_guard lock(mutex_);
    if (lent_ == loans_ || taken_ == submitted_ || !job(taken_).done) {
        return std::nullopt;
    }
    Job& next = job(taken_++);
    Decoded decoded{next.jpeg, {next.jpeg.data, next.jpeg.bytes}, std::move(next.problem)};
    decoded.frame.data = frames_[static_cast<std::size_t>(next.slot)].data();
    decoded.frame.loan = next.slot;
    if (decoded.problem.empty()) {
        ++lent_;
        jpeg_loans_[static_cast<std::size_t>(next.slot)] = next.jpeg.loan;
    } else {
        drop(next);
    }
    return decoded;
}

void JpegWorkers::forget() {
    std::unique_lock lock(mutex_);
    const std::uint64_t kept = begun_;
    for (; submitted_ > kept; --submitted_) {
        drop(job(submitted_ - 1));
    }
    for (; taken_ < submitted_; ++taken_) {
        changed_.wait(lock, [this] { return job(taken_).done; });
        drop(job(taken_));
    }
}

void JpegWorkers::drop(const Job& job) {
    stream_.give_back(job.jpeg.loan);
    free_.give_back(static_cast<std::size_t>(job.slot));
}

void JpegWorkers::give_back(int loan) noexcept {
    {
        const std::lock_guard lock(mutex_);
        stream_.give_back(jpeg_loans_[static_cast<std::size_t>(loan)]);
        free_.give_back(static_cast<std::size_t>(loan));
        --lent_;
    }
    waker_.wake();
}

}  // namespace disparityd::capture
