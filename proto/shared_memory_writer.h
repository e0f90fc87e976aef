// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "proto/shared_memory_layout.h"

namespace disparityd::proto {

/// What a shared-memory object is made for: the size of the rectified image and the planes of every frame.
struct ShmLayout {
    struct Plane {
        std::uint32_t product = 0;  ///< a Product of disparity.proto, each at most once
        std::uint32_t bytes_per_pixel = 0;
    };
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<Plane> planes;
};

/// Where one plane of a frame is copied from. Not owned.
struct PlaneSource {
    std::uint32_t product = 0;
    const void* data = nullptr;
    std::size_t row_bytes = 0;  ///< width * bytes per pixel
    std::size_t stride = 0;     ///< bytes from one row to the next
};

/// The daemon's side of shared memory. Owns the object /disparityd.<name> from construction to close().
///
/// publish(), relayout() and close() belong to one thread at a time; wake() and heartbeat() may be called from any
/// thread at any time, beside them.
class SharedMemoryWriter {
public:
    /// Creates the object, mode 0640, all of its memory reserved. What a daemon that no longer lives has left behind,
    /// or what is no object of disparityd, is replaced: see note(). Throws std::invalid_argument for a name or layout
    /// that is not allowed, std::runtime_error when a living daemon has the name or the system refuses.
    SharedMemoryWriter(const std::string& name, const ShmLayout& layout, std::uint32_t slot_count = 4);
    ~SharedMemoryWriter();
    SharedMemoryWriter(const SharedMemoryWriter&) = delete;
    SharedMemoryWriter& operator=(const SharedMemoryWriter&) = delete;

    /// "/disparityd.<name>"
    const std::string& object_name() const { return object_name_; }

    /// One line for the log when something left over was replaced at construction; otherwise empty.
    const std::string& note() const { return note_; }

    /// Copies a frame into the next slot. `planes` has each plane of the layout once, in any order. Readers that wait
    /// are not woken: call wake() after it, best from a thread that is not in a hurry. Never allocates, never waits.
    /// Throws std::invalid_argument when planes or sizes are not those of the layout (nothing is published then).
    void publish(const ShmFrame& frame, std::span<const PlaneSource> planes);

    /// Wakes every reader that waits for a frame.
    void wake();

    /// Says that the daemon lives; call it at least twice a second.
    void heartbeat();

    /// Replaces the object by one with another layout; readers map the new one by themselves. Throws as the constructor
    /// does; the old object is then still in use.
    void relayout(const ShmLayout& layout);

    /// Tells the readers that the daemon has ended, and removes the name. Done by the destructor too.
    void close();

private:
    /// Makes the new object, gives it the name, and tells the readers of the old one, if any.
    void create(const ShmLayout& layout);
    void unmap();

    std::string object_name_;
    std::string note_;
    std::uint32_t slot_count_;
    std::mutex mutex_;  ///< which object is mapped: wake() and heartbeat() against relayout() and close()
    ShmHeader* header_ = nullptr;
    ShmView view_;
    std::uint64_t inode_ = 0;  ///< a name that another daemon has taken over is left alone
};

}  // namespace disparityd::proto
