// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/calibration_correction.h"
#include "capture/sensor_sample.h"
#include "kernels/raw_image.h"

/// What docs/recordings.md defines: the names and encodings that writer and reader share.
namespace disparityd::capture::recording {

/// Pixels are packed without loss.
inline constexpr std::string_view version_of_pixels = "1";
/// The camera's own JPEGs. Readers that know only the first version refuse it.
inline constexpr std::string_view version_of_jpegs = "2";

/// Tags of the container. A file with others that begin like these, and without the first, is a damaged recording.
inline constexpr const char* tag_prefix = "DISPARITYD_";
inline constexpr const char* tag_format = "DISPARITYD_FORMAT";
inline constexpr const char* tag_source = "DISPARITYD_SOURCE";
inline constexpr const char* tag_synthetic = "DISPARITYD_SYNTHETIC";
inline constexpr const char* tag_time_offset = "DISPARITYD_TIME_OFFSET_US";
inline constexpr const char* tag_pixels = "DISPARITYD_PIXELS";
inline constexpr const char* tag_eye_width = "DISPARITYD_EYE_WIDTH";
/// Of JPEGs, in the words of the source (capture/camera/camera_uri.h): how the eyes lie.
inline constexpr const char* tag_layout = "DISPARITYD_LAYOUT";
inline constexpr const char* tag_first = "DISPARITYD_FIRST";
inline constexpr const char* tag_rate = "DISPARITYD_RATE";
inline constexpr const char* tag_checksums = "DISPARITYD_CHECKSUMS";
inline constexpr const char* tag_frames = "DISPARITYD_FRAMES";
inline constexpr const char* tag_calibration = "DISPARITYD_CALIBRATION";
inline constexpr const char* tag_calibration_id = "DISPARITYD_CALIBRATION_ID";

/// Every frame has checksums (recording_checksum.h); recordings of older versions have none.
inline constexpr std::string_view checksums_kind = "crc32";

/// The frame count has a fixed width, so that it can be filled in when the file is closed.
inline constexpr int frames_digits = 20;
std::string frames_text(std::uint64_t frames);

/// The largest offset of stamps that can be set, in microseconds, either way.
inline constexpr int max_time_offset_us = 100'000;

/// The largest side-by-side picture. No camera comes near it; a damaged file must not claim all memory.
inline constexpr int max_side = 32768;
inline constexpr std::int64_t max_pixels = std::int64_t{1} << 26;

/// Returns the rate itself, or 0 (unknown) when no frames can have it.
double plausible_rate(double rate);

/// What travels beside the pixels of each frame, exactly.
struct FrameFacts {
    std::uint64_t sequence = 0;
    std::int64_t monotonic_ns = 0;
    std::int64_t realtime_ns = 0;
    std::uint32_t flags = 0;
    std::uint32_t dropped_before = 0;
    calibration::CalibrationCorrection correction;
    std::vector<SensorSample> sensors{};  ///< stand behind the rest: recording_sensors.h
};

/// FFmpeg's packet side data: Matroska's BlockAddID (big endian, 1), then the block addition itself.
inline constexpr std::size_t block_add_id_size = 8;
inline constexpr std::size_t facts_size = block_add_id_size + 56;
/// Writes all facts but the sensors.
void put_facts(const FrameFacts& facts, std::span<std::uint8_t, facts_size> bytes);
std::optional<FrameFacts> get_facts(std::span<const std::uint8_t> bytes);

}  // namespace disparityd::capture::recording
