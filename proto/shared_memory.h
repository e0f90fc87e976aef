// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "proto/frame_info.h"

/// Defines the layout of the shared-memory object /disparityd.<name>. docs/protocol.md explains how to read it.
///
/// There is one writer (the daemon) and any number of readers, which map the object read-only. Fields that change after
/// creation are atomics. Everything is little endian. Offsets are bytes from the start of the object.
namespace disparityd::proto {

inline constexpr std::uint64_t shm_magic = 0x3159545241505344ULL;  // "DSPARTY1"
/// Version 3 has more than shm_first_planes planes, version 2 at least one record; all else is version 1, which every
/// reader knows.
inline constexpr std::uint32_t shm_version = 1;
inline constexpr std::uint32_t shm_version_with_records = 2;
inline constexpr std::uint32_t shm_version_with_more_planes = 3;
inline constexpr std::uint32_t shm_first_planes = 8;
inline constexpr std::uint32_t shm_max_planes = 16;

/// Values equal those of Product in disparity.proto.
struct ShmPlane {
    std::uint32_t product;
    std::uint32_t bytes_per_pixel;  ///< 0: a record, no image
    std::uint64_t offset;           ///< from the start of a slot's payload
    std::uint64_t bytes;            ///< dense: width * height * bytes_per_pixel, or those of the record
};

struct ShmHeader {
    std::uint64_t magic;  ///< written last at creation
    std::uint32_t version;
    std::uint32_t header_bytes;
    std::uint64_t total_bytes;
    std::uint32_t slot_count;
    std::uint32_t plane_count;
    std::uint64_t slots_offset;    ///< of the first slot
    std::uint64_t slot_stride;     ///< from one slot to the next: ShmSlot, padding, payload
    std::uint64_t payload_offset;  ///< of the payload within a slot
    std::uint32_t width;
    std::uint32_t height;
    ShmPlane planes[shm_first_planes];

    /// Differs for each new object (restart, reload): readers must map again. 0 = the daemon has closed this object.
    alignas(64) std::atomic<std::uint32_t> generation;
    /// Futex word: changes with every published frame, and when the object is closed.
    std::atomic<std::uint32_t> published;
    /// Counts the frames published so far; the newest is in slot (published_total - 1) % slot_count.
    std::atomic<std::uint64_t> published_total;
    /// CLOCK_MONOTONIC in ns, which a running daemon renews at least twice a second.
    std::atomic<std::int64_t> heartbeat_ns;
    std::atomic<std::uint32_t> writer_pid;
    /// Frames up to this number, counted as published_total, are old: others came since that nobody wanted, and were
    /// not published. A reader waits for a newer one.
    std::atomic<std::uint64_t> outdated_total;

    /// The planes after the first ones, as constant as these. Readers of before end here.
    alignas(64) ShmPlane more_planes[shm_max_planes - shm_first_planes];
};

struct ShmSlot {
    /// Sequence lock: odd while the writer copies; even and changed = another frame.
    alignas(64) std::atomic<std::uint64_t> lock;
    /// CLOCK_MONOTONIC in ns when the frame was published, where frame.age_ns ends; 0 = a daemon that does not say.
    /// Copied as `frame` is.
    std::uint64_t published_ns;
    alignas(64) FrameInfo frame;  ///< copied word by word with relaxed atomics, never with plain loads
};

static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "shared memory needs lock-free 64-bit atomics");
static_assert(sizeof(FrameInfo) % 8 == 0, "copied in words of 8 bytes");

// The offsets that docs/protocol.md gives to other languages.
static_assert(offsetof(ShmHeader, planes) == 64 && sizeof(ShmPlane) == 24 && offsetof(ShmHeader, generation) == 256 &&
              offsetof(ShmHeader, published) == 260 && offsetof(ShmHeader, published_total) == 264 &&
              offsetof(ShmHeader, heartbeat_ns) == 272 && offsetof(ShmHeader, writer_pid) == 280 &&
              offsetof(ShmHeader, outdated_total) == 288 && offsetof(ShmHeader, more_planes) == 320);
static_assert(offsetof(ShmSlot, published_ns) == 8 && offsetof(ShmSlot, frame) == 64);

}  // namespace disparityd::proto
