// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/formats/mcap_writer.h"
#include "tests/formats/svo2_payload.h"

namespace disparityd::test {

/// What a made SVO2 file holds. The layout follows a public description of one camera's files, where it says something;
/// the rest is made up, and marked so. A reader must not depend on what is made up.
struct Svo2File {
    Svo2Payload payload = Svo2Payload::h264_lossless;
    int eye_width = 320;
    int height = 180;  ///< not a multiple of a codec's blocks, as in most modes of the camera
    int disparity = 12;
    int rate = 30;
    int frames = 12;             ///< that the camera took, the lost ones included
    int key_distance = 5;        ///< of the frames that are written
    std::vector<int> lost;       ///< numbers of frames that never reached the encoder
    std::vector<int> unwritten;  ///< numbers of frames that were encoded and are not in the file
    int serial = 31234567;

    std::uint64_t first_ns = 1'717'000'000'123'456'789;  ///< Unix time of frame 0
    std::uint64_t stamp_unit_ns = 1;  ///< of all stamps in messages and footer; the descriptions say ns or ms
    bool width_of_one_eye = false;    ///< in the header and below each frame; the descriptions say one eye or both

    bool has_header = true;
    bool has_sensors = true;
    bool has_footer = true;
    int samples_per_frame = 4;             ///< of the inertial sensor, evenly spaced
    std::string header_text;               ///< instead of the JSON header, if it is not empty
    std::vector<std::string> more_topics;  ///< with a message of noise beside each frame
    std::string video_topic;               ///< instead of Camera_SN<serial>/side_by_side, if it is not empty
    McapFeatures mcap;

    /// Draws frame `number` in place of svo2_picture(). May be empty.
    std::function<Svo2Picture(int number)> draw;

    /// Changes the message of frame `number` before it is written. May be empty.
    std::function<void(std::string& message, int number)> change;
};

/// The inertial sample `index` of such a file.
struct Svo2Sample {
    std::uint64_t time_ns;
    float degrees_per_s[3];
    float metres_per_s2[3];
};
Svo2Sample svo2_sample(const Svo2File& file, int index);

/// The Unix time of frame `number`, rounded down to the file's unit.
std::uint64_t svo2_frame_ns(const Svo2File& file, int number);

/// The numbers of the frames that are in the file, in order.
std::vector<int> svo2_frame_numbers(const Svo2File& file);

/// Makes the file, as bytes. Throws std::runtime_error where FFmpeg has no encoder: ask can_write() first.
std::string svo2_bytes(const Svo2File& file);

/// A file that is told apart by its name and its first bytes only. What follows them is made up: no description is
/// public.
std::string svo1_bytes();

}  // namespace disparityd::test
