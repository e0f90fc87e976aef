// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::proto {

/// What comes with every frame: numbers of the frame itself, and the geometry of the whole rectified image. It lies in
/// this form at the head of each slot of shared memory (docs/protocol.md has the offsets); proto/frame_message.h
/// converts it to and from the message of a socket. Units are those of disparity.proto.
struct FrameInfo {
    std::uint64_t publish_index;  ///< counts from 0
    std::uint64_t sequence;
    std::int64_t monotonic_ns;
    std::int64_t realtime_ns;
    std::int64_t age_ns;  ///< capture to publishing, over a socket to sending; as a client gives it: until it is given
    std::uint64_t dropped_before;
    std::uint64_t calibration_id;
    double f;
    double cx;
    double cy;
    double baseline_mm;
    double disparity_offset;
    std::int32_t d_min;
    std::uint32_t disparities;
    std::int32_t invalid;
    std::uint32_t flags;  ///< FrameFlags of disparity.proto
    std::uint32_t width;
    std::uint32_t height;
};

// clang-format off
/// Lists the fields of FrameInfo. FRAME(name) is a field of v1::Frame, GEOMETRY(name) one of v1::Geometry. The frame
/// structures of the client library have fields of the same names. A new field is a line above and one here.
#define DISPARITYD_FRAME_FIELDS(FRAME, GEOMETRY) \
    FRAME(publish_index)                         \
    FRAME(sequence)                              \
    FRAME(monotonic_ns)                          \
    FRAME(realtime_ns)                           \
    FRAME(age_ns)                                \
    FRAME(dropped_before)                        \
    GEOMETRY(calibration_id)                     \
    GEOMETRY(f)                                  \
    GEOMETRY(cx)                                 \
    GEOMETRY(cy)                                 \
    GEOMETRY(baseline_mm)                        \
    GEOMETRY(disparity_offset)                   \
    GEOMETRY(d_min)                              \
    GEOMETRY(disparities)                        \
    GEOMETRY(invalid)                            \
    FRAME(flags)                                 \
    GEOMETRY(width)                              \
    GEOMETRY(height)
// clang-format on

#define DISPARITYD_ADD_SIZE(name) +sizeof(FrameInfo::name)
static_assert(DISPARITYD_FRAME_FIELDS(DISPARITYD_ADD_SIZE, DISPARITYD_ADD_SIZE) == sizeof(FrameInfo),
              "DISPARITYD_FRAME_FIELDS leaves out a field of FrameInfo, or FrameInfo has a gap");
#undef DISPARITYD_ADD_SIZE
static_assert(sizeof(FrameInfo) == 120, "docs/protocol.md gives the size to other languages");

/// Copies every field of FrameInfo from one structure that has them to another. Other fields of `to` stay as they are.
template <typename To, typename From>
void copy_frame_fields(To& to, const From& from) {
#define DISPARITYD_COPY(name) to.name = from.name;
    DISPARITYD_FRAME_FIELDS(DISPARITYD_COPY, DISPARITYD_COPY)
#undef DISPARITYD_COPY
}

}  // namespace disparityd::proto
