// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "capture/sensor_sample.h"

/// The messages of an SVO2 file as public descriptions have them: docs/recordings.md. Nobody has published a
/// specification, so that each function says where bytes are not as described.
namespace disparityd::capture {

/// The size of both eyes side by side.
struct SvoSize {
    int width = 0;
    int height = 0;
};

/// What the message on the topic svo_header says.
struct SvoHeader {
    std::string sdk_version;  ///< empty: not said
    std::string serial;       ///< empty: not said
    std::optional<SvoSize> size;
    double rate = 0;         ///< frames per second; 0 = not said
    bool encrypted = false;  ///< it says so
};

/// Reads the header, JSON with a structure in base64. Throws std::runtime_error with what is wrong with it.
SvoHeader read_svo_header(std::span<const std::uint8_t> message);

/// Returns the size of both eyes where a file says a width that may be that of one: an eye is at least as wide as it is
/// high. Nothing where no camera has such a picture.
std::optional<SvoSize> both_eyes_size(std::uint64_t width, std::uint64_t height);

/// Returns a time since 1970 in nanoseconds, with the unit (s, ms, us or ns) told by its magnitude. Nothing for numbers
/// that lie between 1973 and 2100 in no unit.
std::optional<std::int64_t> unix_ns(std::uint64_t stamp);

/// What stands behind the payload of a video message.
struct SvoFooter {
    std::optional<SvoSize> size;
    std::uint64_t stamp = 0;  ///< as it stands there
    std::int32_t index = -1;  ///< counts frames
};

/// A video message, taken apart. Views.
struct SvoVideoMessage {
    std::span<const std::uint8_t> payload;
    std::optional<SvoFooter> footer;  ///< nothing where what follows is none
};

/// Throws std::runtime_error with what is wrong with it.
SvoVideoMessage read_svo_video(std::span<const std::uint8_t> message);

/// Reads a message of the sensors, JSON with a structure in base64: angular velocity, acceleration and the time as
/// camera_ns. Throws std::runtime_error with what is wrong with it.
SensorSample read_svo_sensors(std::span<const std::uint8_t> message);

/// What a payload is by its first bytes.
enum class SvoPayload : unsigned char { unknown, annex_b, png, zstd, jpeg_strips };
SvoPayload payload_kind(std::span<const std::uint8_t> payload);

/// Returns the first bytes for a message, such as "1f 8b 08 00".
std::string first_bytes(std::span<const std::uint8_t> bytes);

/// Returns the serial number in "Camera_SN123/side_by_side" where the topic ends in this name.
std::optional<std::string_view> serial_of_topic(std::string_view topic, std::string_view name);

}  // namespace disparityd::capture
