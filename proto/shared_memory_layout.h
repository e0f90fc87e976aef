// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "proto/shared_memory.h"

namespace disparityd::proto {

/// A program's own copy of an object's header, made when the header was checked: later writes to the header have no
/// effect on the program.
struct ShmView {
    std::uint64_t total_bytes = 0;
    std::uint64_t slots_offset = 0;
    std::uint64_t slot_stride = 0;
    std::uint64_t payload_offset = 0;
    std::uint32_t slot_count = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t plane_count = 0;
    std::array<ShmPlane, shm_max_planes> planes{};
};

/// A plane as clients see it: a record is a row of bytes.
struct PlaneShape {
    std::uint32_t width;
    std::uint32_t height;
    std::uint32_t bytes_per_pixel;
};

inline bool is_record(const ShmPlane& plane) {
    return plane.bytes_per_pixel == 0;
}

inline PlaneShape shape_of(const ShmView& view, const ShmPlane& plane) {
    return is_record(plane) ? PlaneShape{static_cast<std::uint32_t>(plane.bytes), 1, 1}
                            : PlaneShape{view.width, view.height, plane.bytes_per_pixel};
}

/// Whether a daemon can have this name: 1 to 64 characters of A-Z a-z 0-9 . _ -
bool is_daemon_name(const std::string& name);

/// Returns the POSIX name "/disparityd.<name>". Throws std::invalid_argument for a name that no daemon can have.
std::string shm_object_name(const std::string& name);

/// Returns the name of the daemon whose object is this file of /dev/shm; nothing when it is another file.
std::optional<std::string> daemon_of_shm_file(const std::string& file);

/// Copies the constant fields into `view` and checks them. `object_bytes` is the true size of the object, all of it
/// mapped. Returns an empty string when the header can be used, otherwise what is wrong, without the object's name.
std::string check_header(const ShmHeader& header, std::uint64_t object_bytes, ShmView& view);

/// Computes offsets and sizes of slots and planes. The caller has set product and bytes_per_pixel of each plane, bytes
/// of each record, plane_count, width, height and slot_count. Throws std::invalid_argument when they are outside the
/// limits of check_header().
void lay_out(ShmView& view);

/// Returns the place of a plane, of 0 .. shm_max_planes - 1, in a header.
template <class Header>
auto& plane_at(Header& header, std::size_t index) {
    return index < shm_first_planes ? header.planes[index] : header.more_planes[index - shm_first_planes];
}

inline const ShmSlot& slot_at(const ShmHeader& header, const ShmView& view, std::uint64_t index) {
    const auto* base = reinterpret_cast<const std::uint8_t*>(&header);
    return *reinterpret_cast<const ShmSlot*>(base + view.slots_offset + index * view.slot_stride);
}

inline const std::uint64_t* plane_words(const ShmSlot& slot, const ShmView& view, const ShmPlane& plane) {
    const auto* base = reinterpret_cast<const std::uint8_t*>(&slot);
    return reinterpret_cast<const std::uint64_t*>(base + view.payload_offset + plane.offset);
}

}  // namespace disparityd::proto
