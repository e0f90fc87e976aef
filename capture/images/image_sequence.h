// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::capture {

/// The files of an image folder or of a pattern, in order.
struct ImageSequence {
    struct Frame {
        std::string left;
        std::string right;         ///< empty: `left` holds both eyes side by side
        std::int64_t time_ns = 0;  ///< as the folder says; meaningless unless `timed`
        std::string calibration;   ///< of this frame alone, as KITTI 2012 and 2015 have it; empty = there is none
    };
    std::vector<Frame> frames;  ///< at least one
    bool timed = false;
    bool rectified = false;   ///< by the layout's own rules
    std::string description;  ///< "Middlebury scene", "KITTI image_2/image_3", "pattern"
    std::string calibration;  ///< calib.txt and the like, of all frames; empty = there is none
    /// The calibration of the inertial sensor, which goes behind `calibration`; empty = there is none.
    std::string inertial_calibration;
    std::string unpaired;  ///< one line: images that belong to no pair; may be empty
    /// data.csv of an inertial sensor, whose times are those of the frames (inertial_list.h); empty = there is none.
    std::string inertial_list;
    int kitti_camera = -1;  ///< number of the left camera in a KITTI calibration; -1 = not KITTI
};

/// The URI of images: a folder, two folders, a pattern, two files as left.png,right.png, each with "?bits=12&imu=off"
/// or a part of it behind.
struct ImageUri {
    std::string path;
    int bits = 0;          ///< of the values in images of 16 bits per channel; 0: as many as the files say
    bool inertial = true;  ///< samples and calibration of the inertial sensor are read, where there is one
};

/// Throws std::invalid_argument with one line for a value that is not allowed.
ImageUri parse_image_uri(const std::string& uri);

/// Frames that follow each other and share their size and their calibration.
struct RunOfOneGeometry {
    std::size_t first = 0;
    std::size_t count = 0;
};

/// Cuts a sequence where the size of the images changes, by their headers, and, where asked, the calibration that some
/// data sets have for each frame: at least one run. An image whose size cannot be told belongs to the run before it.
/// `uri` is that of ImageUri. Throws as parse_image_uri() and find_images(), and for a calibration that cannot be read.
std::vector<RunOfOneGeometry> runs_of_one_geometry(const std::string& uri, bool by_calibration);

/// True for an existing folder or two with a comma between, for names with %d, for one or two names of image files.
bool is_image_sequence(const std::string& uri);

/// Lists the frames; `path` is that of ImageUri. Throws std::invalid_argument with one line when nothing fits or an
/// eye's image is missing.
ImageSequence find_images(const std::string& path);

/// Finds an existing file `stem` with an ending of an image file, in capitals or not; empty = none.
std::string find_image(const std::string& folder, const std::string& stem);

/// The folder pair of a KITTI layout within `folder`.
struct KittiFolders {
    std::string left;  ///< with the images themselves; empty = no such layout
    std::string right;
    std::string name;  ///< "image_2/image_3"
    int left_camera = 0;
};
KittiFolders find_kitti_folders(const std::string& folder);

/// Names of the image files in a folder that are not hidden, sorted.
std::vector<std::string> image_names(const std::string& folder);

}  // namespace disparityd::capture
