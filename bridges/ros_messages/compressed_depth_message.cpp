// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/compressed_depth_message.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "bridges/frames/planes.h"
#include "bridges/frames/rvl.h"
#include "bridges/ros_messages/message_header.h"
#include "formats/pictures/png_writer.h"

namespace disparityd::ros {
namespace {

using disparity::PlaneData;

/// What the transport puts before each picture: the number of its format and two parameters of depths that have
/// floating points, of which 16 bits need none.
constexpr std::size_t config_bytes = 12;

std::string packed(const PlaneData& plane, DepthCodec codec) {
    if (codec == DepthCodec::png) {
        const formats::PngPixels pixels{.data = plane.bytes.data(),
                                        .width = static_cast<int>(plane.width),
                                        .height = static_cast<int>(plane.height),
                                        .row_bytes = std::size_t{2} * plane.width,
                                        .bits = 16};
        return formats::png_of(pixels, formats::PngContent::few_values);
    }
    // Unlike a PNG, RVL does not know the size of the picture.
    const std::array size{plane.width, plane.height};
    std::string bytes(sizeof size, '\0');
    std::memcpy(bytes.data(), size.data(), sizeof size);
    return bytes + frames::rvl_of(plane.bytes);
}

}  // namespace

std::optional<std::string> compressed_depth(const disparity::Frame& frame, DepthCodec codec, const FrameNames& names) {
    const PlaneData* plane = frames::whole_plane(frame, disparity::Product::depth);
    if (plane == nullptr) {
        return std::nullopt;
    }
    const std::string picture = packed(*plane, codec);
    CdrWriter cdr(picture.size() + 256);
    write_header(cdr, frame.realtime_ns, names.left);
    cdr.text(codec == DepthCodec::png ? "16UC1; compressedDepth png" : "16UC1; compressedDepth rvl");
    const std::span<std::uint8_t> room = cdr.u8_room(config_bytes + picture.size());
    std::copy(picture.begin(), picture.end(), room.begin() + config_bytes);
    return cdr.take();
}

}  // namespace disparityd::ros
