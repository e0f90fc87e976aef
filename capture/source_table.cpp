// SPDX-License-Identifier: Apache-2.0
#include "capture/folder_source.h"
#include "capture/frame_source.h"
#include "capture/image_sequence.h"
#include "capture/recording_source.h"
#include "capture/scene_source.h"

namespace disparityd::capture {

const std::vector<SourceKind>& source_kinds() {
    static const std::vector<SourceKind> kinds{
        {"scene", "a rendered scene: scene:vga@15, scene:hd720@30?frames=60&seed=1", is_scene, open_scene},
        {"folder", "a folder of Middlebury or KITTI images, or a pattern: left_%04d.png,right_%04d.png",
         is_image_sequence, open_images},
        {"recording", "a side-by-side video: recording.mkv", is_recording, open_recording},
    };
    return kinds;
}

}  // namespace disparityd::capture
