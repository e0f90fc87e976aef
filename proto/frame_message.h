// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "proto/disparity.pb.h"
#include "proto/frame_info.h"

/// Converts FrameInfo to and from Protobuf. Pure functions: any thread, no errors.
namespace disparityd::proto {

/// The geometry alone, as Welcome and Status carry it.
v1::Geometry to_message(const FrameInfo& info);

/// Sets the fields of `message` that FrameInfo has. What concerns one client only stays as it is: region,
/// skipped and planes.
void fill(v1::Frame& message, const FrameInfo& info);

/// The reverse of fill(). A field that the message lacks is 0.
FrameInfo to_info(const v1::Frame& message);

}  // namespace disparityd::proto
