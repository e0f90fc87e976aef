// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_source.h"
#include "capture/bag/bag_uri.h"
#include "capture/camera/camera_source.h"
#include "capture/frame_source.h"
#include "capture/gstreamer/gst_source.h"
#include "capture/gstreamer/gst_uri.h"
#include "capture/images/folder_source.h"
#include "capture/images/image_sequence.h"
#include "capture/recording/recording_source.h"
#include "capture/scene/scene_source.h"
#include "capture/svo/svo_source.h"

namespace disparityd::capture {

const std::vector<SourceKind>& source_kinds() {
    static const std::vector<SourceKind> kinds{
        {"scene", "a rendered scene: scene:vga@15, scene:hd720@30?frames=60&seed=1", is_scene, open_scene},
        {"v4l2",
         "a stereo camera: v4l2:auto (the first ZED that is there), v4l2:hd720@30, v4l2:vga@100?serial=12345, "
         "v4l2:2560x720@30?device=/dev/video0 (whole "
         "frame); "
         "options format=yuyv|grey|mjpeg|y8i|y12i|bggr8|gbrg8|grbg8|rggb8, layout=side-by-side|top-bottom, "
         "first=left|right (the eye in the left or "
         "upper "
         "half), port=USB-PORT; two cameras: v4l2:640x480@30?left=/dev/video0&right=/dev/video2",
         is_camera, open_camera},
        {"gst",
         "what GStreamer can open, to an appsink with both eyes side by side, or to two, left and right: gst:v4l2src "
         "device=/dev/video0 ! image/jpeg ! jpegdec ! appsink; gst?within_ms=10:... is how far apart the stamps of two "
         "eyes may be",
         is_gst, open_gst},
        {"bag",
         "a ROS bag: recording.mcap, recording.db3 or the folder of one, recording.bag of ROS 1; which of several "
         "pairs of topics with images is read "
         "stands "
         "behind it: recording.mcap?left=/left/image_raw&right=/right/image_raw",
         is_bag, open_bag, true},
        {"svo2",
         "experimental: a recording of the ZED SDK from 4.1 on, with the calibration of its camera's serial number: "
         "recording.svo2",
         is_svo, open_svo, true, true},
        {"folder",
         "a folder of Middlebury, KITTI or EuRoC images, or with left/ and right/; two folders LEFT,RIGHT; a pair "
         "left.png,right.png; or a pattern: left_%04d.png,right_%04d.png; "
         "?bits=12 behind it for values of 12 bits in images of 16, ?imu=off without EuRoC's inertial sensor",
         is_image_sequence, open_images, true},
        {"recording", "a side-by-side video: recording.mkv; or one for each eye: left.mp4,right.mp4", is_recording,
         open_recording, true},
    };
    return kinds;
}

}  // namespace disparityd::capture
