// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tests/vm/camera/byte_order.h"

namespace simulated_camera {

/// The setup packet of a control transfer (USB 2.0, 9.3).
struct SetupPacket {
    std::uint8_t request_type;
    std::uint8_t request;
    std::uint16_t value;
    std::uint16_t index;
    std::uint16_t length;

    bool to_host() const { return (request_type & 0x80) != 0; }
    bool is_class() const { return (request_type & 0x60) == 0x20; }
    std::uint8_t recipient() const { return request_type & 0x1f; }
    std::uint8_t value_high() const { return static_cast<std::uint8_t>(value >> 8); }
    std::uint8_t value_low() const { return static_cast<std::uint8_t>(value); }
    std::uint8_t index_high() const { return static_cast<std::uint8_t>(index >> 8); }
    std::uint8_t index_low() const { return static_cast<std::uint8_t>(index); }
};

/// What a control transfer gives back: data for the host (empty for one to the device), or nothing: a stall.
using ControlAnswer = std::optional<Bytes>;

/// Standard requests (USB 2.0, table 9-4; the last two are USB 3's).
enum StandardRequest : std::uint8_t {
    get_status = 0,
    clear_feature = 1,
    set_feature = 3,
    get_descriptor = 6,
    get_configuration = 8,
    set_configuration = 9,
    get_interface = 10,
    set_interface = 11,
    set_exit_latency = 48,
    set_isochronous_delay = 49
};

/// Requests of the USB video class (UVC 1.1, A.8).
namespace uvc_request {
inline constexpr std::uint8_t set_cur = 0x01;
inline constexpr std::uint8_t get_cur = 0x81;
inline constexpr std::uint8_t get_min = 0x82;
inline constexpr std::uint8_t get_max = 0x83;
inline constexpr std::uint8_t get_res = 0x84;
inline constexpr std::uint8_t get_len = 0x85;
inline constexpr std::uint8_t get_info = 0x86;
inline constexpr std::uint8_t get_def = 0x87;
}  // namespace uvc_request

/// What GET_INFO says of a control that can be read and written.
inline constexpr std::uint8_t readable_and_writable = 3;

/// Numbers of the units in the camera's control interface.
namespace unit_id {
inline constexpr std::uint8_t camera_terminal = 1;
inline constexpr std::uint8_t processing = 2;
inline constexpr std::uint8_t output_terminal = 3;
inline constexpr std::uint8_t extension = 4;
}  // namespace unit_id

inline constexpr std::uint8_t control_interface = 0;
inline constexpr std::uint8_t streaming_interface = 1;
inline constexpr std::uint8_t video_endpoint = 0x81;

}  // namespace simulated_camera
