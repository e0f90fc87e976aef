// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/svo_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>

#include "base/little_endian.h"
#include "base/words.h"
#include "capture/recording/recording_format.h"
#include "capture/svo/jpeg_strips.h"

namespace disparityd::capture {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Json = nlohmann::json;

constexpr std::size_t most_json = 1 << 20;

std::uint32_t u32_at(Bytes bytes, std::size_t at) {
    return static_cast<std::uint32_t>(base::get_little_endian(&bytes[at], 4));
}

float float_at(Bytes bytes, std::size_t at) {
    const std::uint32_t bits = u32_at(bytes, at);
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

Json object_of(Bytes message) {
    if (message.size() > most_json) {
        throw std::runtime_error("it has " + std::to_string(message.size()) + " bytes, allowed are up to " +
                                 std::to_string(most_json));
    }
    // Strings may end in a zero.
    const auto end = std::find(message.begin(), message.end(), std::uint8_t{0});
    Json json = Json::parse(message.begin(), end, nullptr, false);
    if (!json.is_object()) {
        throw std::runtime_error("it is no JSON object; it begins with the bytes " + first_bytes(message));
    }
    return json;
}

int digit_of(char c) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t at = digits.find(c);
    return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

/// Returns the bytes of base64; nothing for other text.
std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text) {
    while (!text.empty() && (text.back() == '=' || text.back() == '\n')) {
        text.remove_suffix(1);
    }
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    std::uint32_t bits = 0;
    int have = 0;
    for (const char c : text) {
        const int digit = digit_of(c);
        if (digit < 0) {
            return std::nullopt;
        }
        bits = (bits << 6U) | static_cast<std::uint32_t>(digit);
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(have)));
        }
    }
    return bytes;
}

/// Returns the text of the first of the keys that is there, whatever its capitals.
std::string text_of(const Json& json, std::string_view key) {
    for (const auto& [name, value] : json.items()) {
        if (base::lower_case(name) == key && value.is_string()) {
            return value.get<std::string>();
        }
    }
    return {};
}

/// Whether an entry says that the file is encrypted.
bool says_encrypted(const Json& json) {
    return std::any_of(json.items().begin(), json.items().end(), [](const auto& entry) {
        const Json& value = entry.value();
        const bool no = value.is_null() || value == false || value == 0 || value == "";
        return base::lower_case(entry.key()).find("encrypt") != std::string::npos && !no;
    });
}

constexpr std::size_t footer_bytes = 56;

std::optional<SvoFooter> footer_of(Bytes bytes, std::size_t payload_size) {
    constexpr std::size_t stamp_at = 0x18, size_at = 0x20, index_at = 0x30;
    if (bytes.size() < footer_bytes || u32_at(bytes, size_at) != payload_size) {
        return std::nullopt;
    }
    SvoFooter footer;
    footer.size = both_eyes_size(u32_at(bytes, 0), u32_at(bytes, 4));
    footer.stamp = base::get_little_endian(&bytes[stamp_at], 8);
    footer.index = static_cast<std::int32_t>(u32_at(bytes, index_at));
    return footer;
}

}  // namespace

SvoHeader read_svo_header(Bytes message) {
    constexpr std::size_t serial_at = 8, rate_at = 12, least_bytes = 16;
    constexpr std::uint32_t fastest = 1000;
    const Json json = object_of(message);
    SvoHeader header;
    header.sdk_version = text_of(json, "zed_sdk_version");
    header.encrypted = says_encrypted(json);
    const auto bytes = from_base64(text_of(json, "header"));
    if (!bytes || bytes->size() < least_bytes) {
        if (header.encrypted) {
            return header;
        }
        throw std::runtime_error("its entry \"header\" is no structure in base64");
    }
    header.size = both_eyes_size(u32_at(*bytes, 0), u32_at(*bytes, 4));
    const std::uint32_t serial = u32_at(*bytes, serial_at);
    header.serial = serial == 0 ? std::string() : std::to_string(serial);
    const std::uint32_t rate = u32_at(*bytes, rate_at);
    header.rate = rate <= fastest ? rate : 0;
    return header;
}

std::optional<SvoSize> both_eyes_size(std::uint64_t width, std::uint64_t height) {
    if (width < 2 || height < 1 || width > recording::max_side || height > recording::max_side) {
        return std::nullopt;
    }
    const std::uint64_t both = width / 2 >= height ? width : 2 * width;
    if (both % 2 != 0 || both > recording::max_side || both * height > recording::max_pixels) {
        return std::nullopt;
    }
    return SvoSize{static_cast<int>(both), static_cast<int>(height)};
}

std::optional<std::int64_t> unix_ns(std::uint64_t stamp) {
    constexpr std::uint64_t first_s = 100'000'000, end_s = 4'102'444'800;
    constexpr std::uint64_t second_ns = 1'000'000'000;
    for (std::uint64_t unit_ns = second_ns; unit_ns >= 1; unit_ns /= 1000) {
        const std::uint64_t per_second = second_ns / unit_ns;
        if (stamp >= first_s * per_second && stamp < end_s * per_second) {
            return static_cast<std::int64_t>(stamp * unit_ns);
        }
    }
    return std::nullopt;
}

SvoVideoMessage read_svo_video(Bytes message) {
    constexpr std::size_t head = 8;
    if (message.size() < head) {
        throw std::runtime_error("it has " + std::to_string(message.size()) + " bytes");
    }
    const std::uint64_t follows = u32_at(message, 0);
    const std::uint64_t size = u32_at(message, 4);
    if (follows + 4 > message.size() || size + 4 > follows) {
        // A description of JPEGs has them to the end of the message, behind 8 bytes that it takes for times.
        if (!jpeg_strips_of(message.subspan(head)).empty()) {
            return {message.subspan(head), std::nullopt};
        }
        throw std::runtime_error("its sizes do not fit: " + std::to_string(follows) + " and " + std::to_string(size) +
                                 " in a message of " + std::to_string(message.size()) +
                                 " bytes, which begins with the bytes " + first_bytes(message));
    }
    const auto payload = static_cast<std::size_t>(size);
    return {message.subspan(head, payload), footer_of(message.subspan(head + payload), payload)};
}

SensorSample read_svo_sensors(Bytes message) {
    constexpr std::size_t structure_bytes = 360, stamp_at = 0x10, velocity_at = 0x58, acceleration_at = 0x64;
    constexpr float radians = std::numbers::pi_v<float> / 180;
    const Json json = object_of(message);
    std::string sizes;
    for (const auto& entry : json) {
        const auto bytes = entry.is_string() ? from_base64(entry.get_ref<const std::string&>()) : std::nullopt;
        if (!bytes) {
            continue;
        }
        if (bytes->size() != structure_bytes) {
            sizes += (sizes.empty() ? "" : ", ") + std::to_string(bytes->size());
            continue;
        }
        const auto stamp = unix_ns(base::get_little_endian(&(*bytes)[stamp_at], 8));
        if (!stamp) {
            throw std::runtime_error("its time stamp is no time since 1970");
        }
        const auto vector = [&](std::size_t at, float unit) {
            return SensorVector{unit * float_at(*bytes, at), unit * float_at(*bytes, at + 4),
                                unit * float_at(*bytes, at + 8)};
        };
        SensorSample sample;
        sample.camera_ns = *stamp;
        sample.flags = sensor_flag_inertial;
        sample.angular_velocity = vector(velocity_at, radians);
        sample.acceleration = vector(acceleration_at, 1);
        return sample;
    }
    throw std::runtime_error("it has no structure of " + std::to_string(structure_bytes) + " bytes in base64" +
                             (sizes.empty() ? "" : ", found " + sizes));
}

SvoPayload payload_kind(Bytes payload) {
    const auto begins = [&](std::initializer_list<std::uint8_t> bytes) {
        return payload.size() >= bytes.size() && std::equal(bytes.begin(), bytes.end(), payload.begin());
    };
    if (begins({0, 0, 0, 1}) || begins({0, 0, 1})) {
        return SvoPayload::annex_b;
    }
    if (begins({0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'})) {
        return SvoPayload::png;
    }
    if (begins({0x28, 0xB5, 0x2F, 0xFD})) {
        return SvoPayload::zstd;
    }
    return jpeg_strips_of(payload).empty() ? SvoPayload::unknown : SvoPayload::jpeg_strips;
}

std::string first_bytes(Bytes bytes) {
    constexpr std::size_t shown = 8;
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes.first(std::min(shown, bytes.size()))) {
        text += text.empty() ? "" : " ";
        text += digits[byte >> 4U];
        text += digits[byte & 15U];
    }
    return text;
}

std::optional<std::string_view> serial_of_topic(std::string_view topic, std::string_view name) {
    constexpr std::string_view begin = "Camera_SN";
    if (!topic.starts_with(begin) || !topic.ends_with(name)) {
        return std::nullopt;
    }
    topic.remove_prefix(begin.size());
    const std::string_view serial = topic.substr(0, topic.find('/'));
    const bool digits = !serial.empty() && serial.find_first_not_of("0123456789") == std::string_view::npos;
    if (!digits || topic.size() != serial.size() + 1 + name.size()) {
        return std::nullopt;
    }
    return serial;
}

}  // namespace disparityd::capture
