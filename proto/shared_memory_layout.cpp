// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_layout.h"

#include <atomic>
#include <bit>
#include <stdexcept>
#include <string_view>

namespace disparityd::proto {
namespace {

static_assert(std::endian::native == std::endian::little, "the layout is little endian");

constexpr std::string_view before_name = "/disparityd.";
constexpr std::uint64_t alignment = 64;
constexpr std::uint32_t max_side = 16384;
constexpr std::uint32_t max_slots = 64;
constexpr std::uint32_t max_bytes_per_pixel = 8;
/// As a client of the socket sees a record: a row of so many pixels of one byte at most.
constexpr std::uint64_t max_record_bytes = 16384;

std::uint64_t round_up(std::uint64_t value) {
    return (value + alignment - 1) / alignment * alignment;
}

template <class T>
T load(const T& field) {
    return std::atomic_ref<T>(const_cast<T&>(field)).load(std::memory_order_relaxed);
}

std::string out_of_range(const char* what, std::uint64_t found, std::uint64_t least, std::uint64_t most) {
    if (found >= least && found <= most) {
        return {};
    }
    return std::string(what) + " " + std::to_string(found) + ", allowed " + std::to_string(least) + ".." +
           std::to_string(most);
}

std::string check_counts(const ShmView& view) {
    std::string wrong = out_of_range("width", view.width, 1, max_side);
    if (wrong.empty()) {
        wrong = out_of_range("height", view.height, 1, max_side);
    }
    if (wrong.empty()) {
        wrong = out_of_range("slot count", view.slot_count, 2, max_slots);
    }
    if (wrong.empty()) {
        wrong = out_of_range("plane count", view.plane_count, 0, shm_max_planes);
    }
    for (std::uint32_t i = 0; wrong.empty() && i < view.plane_count; ++i) {
        const ShmPlane& plane = view.planes[i];
        wrong = is_record(plane) ? out_of_range("record bytes", plane.bytes, 1, max_record_bytes)
                                 : out_of_range("bytes per pixel", plane.bytes_per_pixel, 1, max_bytes_per_pixel);
    }
    return wrong;
}

std::uint64_t plane_bytes(const ShmView& view, const ShmPlane& plane) {
    const PlaneShape shape = shape_of(view, plane);
    return std::uint64_t{shape.width} * shape.height * shape.bytes_per_pixel;
}

/// Whether everything that the offsets reach lies inside the object. No sum in it can overflow.
bool inside(const ShmView& view, std::uint64_t header_bytes) {
    const std::uint64_t min_header =
        view.plane_count > shm_first_planes ? sizeof(ShmHeader) : offsetof(ShmHeader, more_planes);
    const bool aligned =
        view.slots_offset % alignment == 0 && view.slot_stride % alignment == 0 && view.payload_offset % alignment == 0;
    if (!aligned || header_bytes < min_header || view.slots_offset < header_bytes ||
        view.slots_offset > view.total_bytes || view.payload_offset < sizeof(ShmSlot) ||
        view.payload_offset > view.slot_stride ||
        view.slot_stride > (view.total_bytes - view.slots_offset) / view.slot_count) {
        return false;
    }
    const std::uint64_t payload = view.slot_stride - view.payload_offset;
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        const ShmPlane& plane = view.planes[i];
        if (plane.bytes != plane_bytes(view, plane) || plane.offset % alignment != 0 || plane.offset > payload ||
            round_up(plane.bytes) > payload - plane.offset) {
            return false;
        }
    }
    return true;
}

}  // namespace

bool is_daemon_name(const std::string& name) {
    constexpr const char* allowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    return !name.empty() && name.size() <= 64 && name.find_first_not_of(allowed) == std::string::npos;
}

std::string shm_object_name(const std::string& name) {
    if (!is_daemon_name(name)) {
        throw std::invalid_argument("shared memory name \"" + name +
                                    "\": 1 to 64 characters are allowed, of A-Z a-z 0-9 . _ -");
    }
    return std::string(before_name) + name;
}

std::optional<std::string> daemon_of_shm_file(const std::string& file) {
    constexpr std::string_view start = before_name.substr(1);
    const std::string name = file.starts_with(start) ? file.substr(start.size()) : std::string();
    return is_daemon_name(name) ? std::optional(name) : std::nullopt;
}

std::string check_header(const ShmHeader& header, std::uint64_t object_bytes, ShmView& view) {
    if (object_bytes < sizeof(ShmHeader)) {
        return "has " + std::to_string(object_bytes) + " bytes, its header alone has " +
               std::to_string(sizeof(ShmHeader));
    }
    if (std::atomic_ref<std::uint64_t>(const_cast<std::uint64_t&>(header.magic)).load(std::memory_order_acquire) !=
        shm_magic) {
        return "was not made by disparityd";
    }
    const std::uint32_t version = load(header.version);
    if (version < shm_version || version > shm_version_with_more_planes) {
        return "has layout version " + std::to_string(version) + ", this program knows " + std::to_string(shm_version) +
               " to " + std::to_string(shm_version_with_more_planes) +
               ": use the client library that came with the daemon";
    }
    view.total_bytes = load(header.total_bytes);
    view.slots_offset = load(header.slots_offset);
    view.slot_stride = load(header.slot_stride);
    view.payload_offset = load(header.payload_offset);
    view.slot_count = load(header.slot_count);
    view.width = load(header.width);
    view.height = load(header.height);
    view.plane_count = load(header.plane_count);
    const std::uint32_t max_planes = version < shm_version_with_more_planes ? shm_first_planes : shm_max_planes;
    if (const std::string wrong = out_of_range("plane count", view.plane_count, 0, max_planes); !wrong.empty()) {
        return "is damaged: " + wrong;
    }
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        const ShmPlane& plane = plane_at(header, i);
        view.planes[i] = {load(plane.product), load(plane.bytes_per_pixel), load(plane.offset), load(plane.bytes)};
    }
    if (view.total_bytes > object_bytes) {
        return "is damaged: " + std::to_string(object_bytes) + " bytes, its header says " +
               std::to_string(view.total_bytes);
    }
    if (const std::string wrong = check_counts(view); !wrong.empty()) {
        return "is damaged: " + wrong;
    }
    if (!inside(view, load(header.header_bytes))) {
        return "is damaged: its header points outside the object";
    }
    return {};
}

void lay_out(ShmView& view) {
    if (const std::string wrong = check_counts(view); !wrong.empty()) {
        throw std::invalid_argument("shared memory layout: " + wrong);
    }
    view.payload_offset = round_up(sizeof(ShmSlot));
    std::uint64_t used = 0;
    for (std::uint32_t i = 0; i < view.plane_count; ++i) {
        for (std::uint32_t j = 0; j < i; ++j) {
            if (view.planes[i].product == view.planes[j].product) {
                throw std::invalid_argument("shared memory layout: product " + std::to_string(view.planes[i].product) +
                                            " is there twice");
            }
        }
        view.planes[i].offset = used;
        view.planes[i].bytes = plane_bytes(view, view.planes[i]);
        used += round_up(view.planes[i].bytes);
    }
    view.slots_offset = round_up(sizeof(ShmHeader));
    view.slot_stride = view.payload_offset + used;
    view.total_bytes = view.slots_offset + view.slot_count * view.slot_stride;
}

}  // namespace disparityd::proto
