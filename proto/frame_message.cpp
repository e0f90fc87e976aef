// SPDX-License-Identifier: Apache-2.0
#include "proto/frame_message.h"

namespace disparityd::proto {
namespace {

void fill_geometry(v1::Geometry& message, const FrameInfo& info) {
#define DISPARITYD_SKIP(name)
#define DISPARITYD_SET(name) message.set_##name(info.name);
    DISPARITYD_FRAME_FIELDS(DISPARITYD_SKIP, DISPARITYD_SET)
#undef DISPARITYD_SET
#undef DISPARITYD_SKIP
}

}  // namespace

v1::Geometry to_message(const FrameInfo& info) {
    v1::Geometry message;
    fill_geometry(message, info);
    return message;
}

void fill(v1::Frame& message, const FrameInfo& info) {
#define DISPARITYD_SKIP(name)
#define DISPARITYD_SET(name) message.set_##name(info.name);
    DISPARITYD_FRAME_FIELDS(DISPARITYD_SET, DISPARITYD_SKIP)
#undef DISPARITYD_SET
#undef DISPARITYD_SKIP
    fill_geometry(*message.mutable_geometry(), info);
}

FrameInfo to_info(const v1::Frame& message) {
    FrameInfo info{};
    const v1::Geometry& geometry = message.geometry();
#define DISPARITYD_FROM_FRAME(name) info.name = message.name();
#define DISPARITYD_FROM_GEOMETRY(name) info.name = geometry.name();
    DISPARITYD_FRAME_FIELDS(DISPARITYD_FROM_FRAME, DISPARITYD_FROM_GEOMETRY)
#undef DISPARITYD_FROM_GEOMETRY
#undef DISPARITYD_FROM_FRAME
    return info;
}

}  // namespace disparityd::proto
