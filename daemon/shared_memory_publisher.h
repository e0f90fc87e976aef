// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/published_frame.h"
#include "proto/shared_memory_writer.h"

namespace disparityd::daemon {

/// Serves frames through shared memory: copies them and wakes readers in the caller's thread. A thread of its own
/// renews the heartbeat, and wakes those readers for which the pipeline would wait too long.
class SharedMemoryPublisher {
public:
    /// Throws as proto::SharedMemoryWriter.
    SharedMemoryPublisher(const std::string& name, const StreamLayout& layout, std::uint32_t slots);
    ~SharedMemoryPublisher();
    SharedMemoryPublisher(const SharedMemoryPublisher&) = delete;
    SharedMemoryPublisher& operator=(const SharedMemoryPublisher&) = delete;

    const std::string& object_name() const { return writer_.object_name(); }

    /// Publishes a frame of the layout; one that is `outdated` already no reader gets as a new one. One thread;
    /// allocates nothing.
    void publish(const PublishedFrame& frame, bool outdated);

    /// Returns whether a reader has the memory open. One that does not lock it counts for two seconds after it has
    /// waited for a frame: one that waits now is woken, finds nothing new and waits again. Any thread.
    bool has_reader();

    /// Tells readers that the frames so far are old. Any thread.
    void outdate() { writer_.outdate(); }

    /// Changes the layout and the number of slots, while no thread publishes. Does nothing when they are the same.
    /// Throws as proto::SharedMemoryWriter.
    void relayout(const StreamLayout& layout, std::uint32_t slots);

    /// Returns whether readers still find the object by its name. The thread that calls relayout() calls these two,
    /// also while another thread publishes.
    bool has_name() const { return writer_.has_name(); }

    /// Makes the object anew if it has lost its name. Throws as proto::SharedMemoryWriter.
    void restore() { writer_.restore(); }

private:
    void keep_alive();
    int wake(int most);

    StreamLayout layout_;
    std::uint32_t slots_;
    proto::SharedMemoryWriter writer_;
    /// When a reader was last found waiting.
    std::atomic<std::chrono::steady_clock::time_point> reader_waited_{std::chrono::steady_clock::time_point::min()};
    std::mutex mutex_;
    std::condition_variable changed_;
    bool more_to_wake_ = false;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace disparityd::daemon
