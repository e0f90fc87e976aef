// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/video_stream.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include "tests/vm/camera/test_pattern.h"

namespace simulated_camera {
namespace {

// The header of a payload (UVC 1.1, 2.4.3.3), in its shortest form: length and flags, no clock.
constexpr std::size_t payload_header_bytes = 2;
constexpr std::uint8_t odd_frame_flag = 0x01;
constexpr std::uint8_t end_of_frame_flag = 0x02;
constexpr std::uint8_t error_flag = 0x40;
constexpr std::uint8_t end_of_header_flag = 0x80;

bool take_one(int& count) {
    if (count <= 0) {
        return false;
    }
    --count;
    return true;
}

}  // namespace

FrameFeed::FrameFeed(const std::string& file, bool whole) : from_file_(!file.empty()), whole_(whole) {
    if (!from_file_) {
        return;
    }
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw std::runtime_error(file + ": cannot be read");
    }
    file_.assign(std::istreambuf_iterator<char>(stream), {});
}

std::span<const std::uint8_t> FrameFeed::frame(std::uint32_t number, std::size_t frame_bytes) {
    if (whole_) {
        return file_;
    }
    const std::size_t frames_in_file = file_.size() / frame_bytes;
    if (frames_in_file > 0) {
        return std::span(file_).subspan(number % frames_in_file * frame_bytes, frame_bytes);
    }
    made_.assign(frame_bytes, 0);
    if (!from_file_) {
        fill_pattern(number, made_);
    }
    return made_;
}

VideoStream::VideoStream(FrameFeed& feed, Faults& faults, StreamCounters& counters, UsbIpConnection& host)
    : feed_(feed), faults_(faults), counters_(counters), host_(host) {}

void VideoStream::start(const Mode& mode, std::uint32_t most_payload_bytes) {
    stop();
    frame_bytes_ = mode.frame_bytes();
    most_payload_bytes_ = most_payload_bytes;
    running_ = true;
}

void VideoStream::stop() {
    running_ = false;
    frame_ = {};
    sent_bytes_ = 0;
}

void VideoStream::begin_frame() {
    with_error_ = take_one(faults_.frames_with_error);
    frame_ = feed_.frame(counters_.number, frame_bytes_);
    if (take_one(faults_.frames_short)) {
        frame_ = frame_.first(frame_.size() / 2);
    }
    sent_bytes_ = 0;
}

void VideoStream::tick(std::uint64_t intervals) {
    if (!running_ || faults_.frozen != FrozenUntil::not_frozen || intervals == 0) {
        return;
    }
    counters_.late += intervals - 1;
    counters_.number += static_cast<std::uint32_t>(intervals);
    if (sending()) {
        ++counters_.late;
    } else if (!take_one(faults_.frames_dropped)) {
        begin_frame();
    }
    pump();
}

void VideoStream::submit(Submission submission) {
    submissions_.push_back(std::move(submission));
    pump();
}

bool VideoStream::withdraw(std::uint32_t sequence) {
    return std::erase_if(submissions_, [&](const Submission& each) { return each.sequence == sequence; }) > 0;
}

std::size_t VideoStream::write_payload(std::span<std::uint8_t> room) {
    const std::size_t length = std::min(room.size() - payload_header_bytes, frame_.size() - sent_bytes_);
    std::copy_n(frame_.begin() + static_cast<std::ptrdiff_t>(sent_bytes_), length, room.begin() + payload_header_bytes);
    sent_bytes_ += length;
    room[0] = payload_header_bytes;
    room[1] = static_cast<std::uint8_t>(end_of_header_flag | (odd_frame_ ? odd_frame_flag : 0) |
                                        (with_error_ ? error_flag : 0) | (sending() ? 0 : end_of_frame_flag));
    if (!sending()) {
        odd_frame_ = !odd_frame_;
        ++counters_.sent;
    }
    return payload_header_bytes + length;
}

void VideoStream::fill_bulk(const Submission& submission) {
    payload_.resize(std::min<std::size_t>(submission.length, most_payload_bytes_));
    const std::size_t length = payload_.size() > payload_header_bytes ? write_payload(payload_) : 0;
    host_.complete(submission.sequence, 0, std::span(payload_).first(length));
}

// Each packet holds a payload of its own; the packets after the end of a frame stay empty.
void VideoStream::fill_packets(const Submission& submission) {
    const auto& lengths = submission.packet_lengths;
    payload_.resize(std::accumulate(lengths.begin(), lengths.end(), std::size_t{0}));
    std::vector<std::uint32_t> got(lengths.size(), 0);
    std::size_t filled = 0;
    for (std::size_t i = 0; i < lengths.size() && sending(); ++i) {
        if (lengths[i] > payload_header_bytes) {
            got[i] = static_cast<std::uint32_t>(write_payload(std::span(payload_).subspan(filled, lengths[i])));
            filled += got[i];
        }
    }
    host_.complete_packets(submission.sequence, std::span(payload_).first(filled), lengths, got);
}

void VideoStream::pump() {
    while (running_ && faults_.frozen == FrozenUntil::not_frozen && !submissions_.empty()) {
        const bool stalled = faults_.transfers_stalled > 0;
        if (!stalled && !sending()) {
            return;
        }
        const Submission submission = std::move(submissions_.front());
        submissions_.pop_front();
        if (stalled) {
            --faults_.transfers_stalled;
            host_.complete(submission.sequence, -EPIPE, {});
        } else if (submission.packet_lengths.empty()) {
            fill_bulk(submission);
        } else {
            fill_packets(submission);
        }
    }
}

}  // namespace simulated_camera
