// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/other_recordings.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "base/words.h"

namespace disparityd::capture {
namespace {

using namespace std::string_view_literals;

constexpr const char* as_svo =
    "is a recording of the ZED SDK (SVO), which only that SDK can read; its sample \"SVO Export\" makes a side-by-side "
    "AVI or two folders of images of it, and both are read here";
constexpr const char* as_bag =
    "is a ROS bag, which is not read; export the raw images of both eyes (ROS 1: rosrun image_view extract_images; ROS "
    "2: ros2 run image_view extract_images_sync) to two folders and name them: left_folder,right_folder";

struct OtherKind {
    std::string_view begins;  ///< the file's first bytes
    const char* what;
    std::size_t at = 0;  ///< where these stand
};

constexpr const char* as_other_image =
    "is an image of a kind that is not read; convert it, and that of the other eye, to PNG";

constexpr std::array other_kinds{
    OtherKind{"\0SVO"sv, as_svo},
    OtherKind{"#ROSBAG"sv, as_bag},
    OtherKind{"SQLite format 3\0"sv, as_bag},
    OtherKind{
        "\x89MCAP"sv,
        "is an MCAP recording, which is not read; export the raw images of both eyes to two folders and name them: "
        "left_folder,right_folder"},
    OtherKind{"PK\x03\x04"sv, "is a ZIP archive: unpack it"},
    OtherKind{"\x1f\x8b"sv, "is compressed with gzip: unpack it"},
    OtherKind{"\xfd"
              "7zXZ"sv,
              "is compressed with xz: unpack it"},
    OtherKind{"\x28\xb5\x2f\xfd"sv, "is compressed with zstd: unpack it"},
    OtherKind{"7z\xbc\xaf"sv, "is a 7-Zip archive: unpack it"},
    OtherKind{"Rar!"sv, "is a RAR archive: unpack it"},
    OtherKind{"\x89HDF"sv, "is an HDF5 file, which is not read; expected a video or images"},
    OtherKind{"\x93NUMPY"sv, "is an array of NumPy, which is not read; expected a video or images"},
    OtherKind{"%PDF"sv, "is a PDF document; expected a video or images"},
    OtherKind{"\x7f"
              "ELF"sv,
              "is a program; expected a video or images"},
    OtherKind{"GIF8"sv, as_other_image},
    OtherKind{"\x76\x2f\x31\x01"sv, as_other_image},  // OpenEXR
    OtherKind{"\0\0\0\x0cJXL "sv, as_other_image},
    OtherKind{"ftyphei"sv, as_other_image, 4},
    OtherKind{"ftypmif1"sv, as_other_image, 4},
    OtherKind{"ftypavif"sv, as_other_image, 4},
    OtherKind{"Pf\n"sv, as_other_image},  // PFM, of which ground truth is read
    OtherKind{"PF\n"sv, as_other_image},
    OtherKind{
        "II*\0"sv,
        "is an image (TIFF, or raw data of a camera): give that of each eye, with names that end in .tif; convert "
        "raw data to PNG"},
    OtherKind{"MM\0*"sv, "is an image (TIFF): give that of each eye, with names that end in .tif"},
    OtherKind{"\x89PNG"sv, "is an image (PNG): give that of each eye, with names that end in .png"},
    OtherKind{"\xff\xd8\xff"sv, "is an image (JPEG): give that of each eye, with names that end in .jpg"},
};

}  // namespace

std::optional<std::string> known_otherwise(const std::string& path, std::span<const std::uint8_t> head) {
    const std::string ending = base::lower_case(std::filesystem::path(path).extension().string());
    if (ending == ".svo" || ending == ".svo2") {  // the second is MCAP inside
        return as_svo;
    }
    const std::string_view bytes(reinterpret_cast<const char*>(head.data()), head.size());
    for (const OtherKind& kind : other_kinds) {
        if (bytes.substr(std::min(kind.at, bytes.size())).starts_with(kind.begins)) {
            return kind.what;
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::capture
