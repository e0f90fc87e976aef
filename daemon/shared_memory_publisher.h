// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/published_frame.h"
#include "proto/shared_memory_writer.h"

namespace disparityd::daemon {

/// Serves frames through shared memory: copies them in the caller's thread, wakes the readers and renews the heartbeat
/// in a thread of its own, so that the pipeline does not pay for the readers.
class SharedMemoryPublisher {
public:
    /// Throws as proto::SharedMemoryWriter.
    SharedMemoryPublisher(const std::string& name, const StreamLayout& layout, std::uint32_t slots);
    ~SharedMemoryPublisher();
    SharedMemoryPublisher(const SharedMemoryPublisher&) = delete;
    SharedMemoryPublisher& operator=(const SharedMemoryPublisher&) = delete;

    const std::string& object_name() const { return writer_.object_name(); }

    /// Publishes a frame of the layout. One thread; allocates nothing.
    void publish(const PublishedFrame& frame);

    /// Changes the layout, while no thread publishes. Does nothing when it is the same. Throws as
    /// proto::SharedMemoryWriter.
    void relayout(const StreamLayout& layout);

    /// Returns whether readers still find the object by its name. The thread that calls relayout() calls these two,
    /// also while another thread publishes.
    bool has_name() const { return writer_.has_name(); }

    /// Makes the object anew if it has lost its name. Throws as proto::SharedMemoryWriter.
    void restore() { writer_.restore(); }

private:
    void wake_readers();

    StreamLayout layout_;
    proto::SharedMemoryWriter writer_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool new_frame_ = false;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace disparityd::daemon
