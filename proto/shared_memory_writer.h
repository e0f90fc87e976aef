// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <climits>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include "proto/mapping.h"
#include "proto/monotonic_clock.h"
#include "proto/shared_memory_layout.h"

namespace disparityd::proto {

/// Says what a shared-memory object holds: the size of the rectified image and the planes of every frame.
struct ShmLayout {
    struct Plane {
        std::uint32_t product = 0;          ///< a Product of disparity.proto, each at most once
        std::uint32_t bytes_per_pixel = 0;  ///< 0: a record
        std::uint64_t record_bytes = 0;     ///< of a record
    };
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<Plane> planes;
};

/// Says where publish() copies one plane of a frame from. Not owned.
struct PlaneSource {
    std::uint32_t product = 0;
    const void* data = nullptr;
    std::size_t row_bytes = 0;  ///< width * bytes per pixel
    std::size_t stride = 0;     ///< bytes from one row to the next
};

/// Writes shared memory for the daemon. Owns the object /disparityd.<name> from construction to close().
///
/// One thread at a time calls publish(), relayout() and close(). Any thread may call wake(), heartbeat(),
/// has_reader() and outdate() at any time. has_name() and restore() may run beside publish(); otherwise the thread that
/// calls relayout() calls them.
class SharedMemoryWriter {
public:
    /// Creates the object with mode 0640 and reserves all of its memory. Replaces an object that a daemon which no
    /// longer runs has left, or that is not disparityd's: see note(). Throws std::invalid_argument for a name or layout
    /// that is not allowed. Throws std::runtime_error when a running daemon or another user's object has the name (root
    /// replaces the latter), or the system refuses.
    SharedMemoryWriter(const std::string& name, const ShmLayout& layout, std::uint32_t slot_count = 4);
    ~SharedMemoryWriter();
    SharedMemoryWriter(const SharedMemoryWriter&) = delete;
    SharedMemoryWriter& operator=(const SharedMemoryWriter&) = delete;

    /// Returns "/disparityd.<name>".
    const std::string& object_name() const { return object_name_; }

    /// Returns one line for the log when the constructor replaced an object; otherwise empty.
    const std::string& note() const { return note_; }

    /// Copies a frame into the next slot. `planes` has each plane of the layout once, in any order. It does not wake
    /// readers: call wake() after it. It never allocates. It waits for restore() only, while
    /// that exchanges a pointer. Throws std::invalid_argument, and publishes nothing, when planes or sizes are not
    /// those of the layout. `published_ns`: the instant where frame.age_ns ends. `outdated`: the frame is old already,
    /// no reader gets it as a new one.
    void publish(const FrameInfo& frame, std::span<const PlaneSource> planes,
                 std::int64_t published_ns = monotonic_ns(), bool outdated = false);

    /// Wakes readers that wait for a frame, but not more than `most`. Returns how many it woke.
    int wake(int most = INT_MAX);

    /// Renews the heartbeat; call it at least twice a second.
    void heartbeat();

    /// Returns whether a reader has the object mapped. One that does not lock it (proto/reader_lock.h) is not seen.
    bool has_reader();

    /// Tells readers that the frames so far are old: those that have not read them wait for a newer one.
    void outdate();

    /// Replaces the object by one with another layout; readers map the new one. Throws as the constructor does; the old
    /// object then stays in use.
    void relayout(const ShmLayout& layout) { relayout(layout, slot_count_); }
    /// The same, with another number of slots.
    void relayout(const ShmLayout& layout, std::uint32_t slot_count);

    /// Whether the name still belongs to this object. Another process may have removed or replaced it.
    bool has_name() const;

    /// Creates a new object with the same layout and no frame if this one has lost its name; readers of the old one map
    /// the new one. Throws as relayout().
    void restore();

    /// Tells the readers that the daemon has ended, and removes the name. The destructor calls it.
    void close();

private:
    /// Creates the new object, gives it the name, and tells the readers of the old one, if any. Returns the note().
    std::string create(const ShmLayout& layout);

    std::string object_name_;
    std::string note_;
    std::uint32_t slot_count_;
    ShmLayout layout_;
    std::mutex publishing_;  ///< publish() against restore(); taken before the other one
    std::mutex mutex_;       ///< which object is mapped: what any thread may call against relayout() and close()
    ShmHeader* header_ = nullptr;
    std::unique_ptr<const Descriptor> file_;  ///< of the object
    ShmView view_;
    dev_t device_ = 0;  ///< with inode_: a name that another daemon has taken over is left alone
    ino_t inode_ = 0;
};

}  // namespace disparityd::proto
