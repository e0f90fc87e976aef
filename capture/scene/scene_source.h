// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "capture/frame_source.h"

namespace disparityd::capture {

bool is_scene(const std::string& uri);  ///< "scene:..."

/// A rendered 3-D scene as a ZED would see it. The frames are rendered here, ahead of time, then played over and over;
/// next() neither draws nor copies nor allocates.
///
/// With Pace::source it behaves like a live camera at the asked rate: whoever is more than a few frames late loses the
/// oldest ones, which are counted. With Pace::fastest nothing is lost and the times are those of an ideal clock, so
/// that every run gives the same. SourceOptions::loop means nothing here. An exception thrown by
/// SourceOptions::progress ends the rendering and passes through.
std::unique_ptr<FrameSource> open_scene(const SourceOptions& options);

}  // namespace disparityd::capture
