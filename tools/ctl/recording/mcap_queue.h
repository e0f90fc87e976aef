// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "clients/cpp/disparity_client.hpp"

namespace disparityd::tools {

/// Hands frames and samples to a thread of its own that writes them, so that who reads them never waits. Of frames that
/// wait there are few: a newer one takes the place of the oldest. One thread calls it.
class McapQueue {
public:
    static constexpr std::size_t most_frames = 8;
    static constexpr std::size_t most_samples = 20'000;

    /// Called in the thread of the queue, one at a time. What they throw ends the writing.
    struct Takers {
        std::function<void(const disparity::Frame& frame)> frame;
        std::function<void(const disparity::SensorSample& sample)> sample;
    };

    /// Throws std::runtime_error when the system starts no more threads.
    explicit McapQueue(Takers takers);
    ~McapQueue();  ///< what waits is not written
    McapQueue(const McapQueue&) = delete;
    McapQueue& operator=(const McapQueue&) = delete;

    void push(disparity::Frame frame);
    void push(const std::vector<disparity::SensorSample>& samples);

    /// Writes what waits and ends the thread. Nothing is pushed afterwards.
    void finish();

    std::uint64_t kept() const;             ///< frames that were written or wait
    std::uint64_t dropped() const;          ///< frames that were not written for newer ones
    std::uint64_t dropped_samples() const;  ///< the same of samples

    /// Throws what a taker has thrown. Nothing more is written then.
    void check() const;

private:
    void run();
    void end(bool with_rest);

    const Takers takers_;
    mutable std::mutex mutex_;  ///< all below
    std::condition_variable changed_;
    std::deque<disparity::Frame> frames_;
    std::deque<disparity::SensorSample> samples_;
    std::uint64_t pushed_ = 0;
    std::uint64_t dropped_ = 0;
    std::uint64_t dropped_samples_ = 0;
    bool ending_ = false;
    std::exception_ptr failure_;
    std::thread thread_;  ///< the last: it uses all others
};

}  // namespace disparityd::tools
