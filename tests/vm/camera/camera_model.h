// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace simulated_camera {

inline constexpr std::uint16_t vendor_id = 0x2b03;

/// A camera as its USB ids tell it.
struct Model {
    std::string_view name;  ///< as given to --model
    std::uint16_t product_id;
    std::uint16_t sensor_product_id;  ///< 0: no sensors
    std::string_view product;         ///< USB product string
    bool old_firmware;                ///< gives only the smallest mode
};

inline constexpr std::array<Model, 6> models{{{"zed", 0xf582, 0, "ZED", false},
                                              {"zed-old", 0xf580, 0, "ZED", true},
                                              {"mini", 0xf682, 0xf681, "ZED-M", false},
                                              {"mini-old", 0xf680, 0xf681, "ZED-M", true},
                                              {"zed2", 0xf780, 0xf781, "ZED 2", false},
                                              {"zed2i", 0xf880, 0xf881, "ZED 2i", false}}};

/// A capture mode; both eyes side by side, YUYV.
struct Mode {
    std::uint16_t width;  ///< both eyes, pixels
    std::uint16_t height;
    std::array<int, 4> rates;  ///< frames per second, highest first, then zeros

    std::uint32_t frame_bytes() const { return std::uint32_t{2} * width * height; }
};

/// The smallest mode stands last: it is the only one that USB 2 and old firmware offer.
inline constexpr std::array<Mode, 4> modes{
    {{4416, 1242, {15}}, {3840, 1080, {30, 15}}, {2560, 720, {60, 30, 15}}, {1344, 376, {100, 60, 30, 15}}}};

enum class Link { usb2, usb3 };
enum class Transfer { bulk, isochronous };

/// What the command line decides about the camera.
struct CameraOptions {
    const Model* model = &models[0];
    Link link = Link::usb3;
    Transfer transfer = Transfer::bulk;
    std::uint32_t serial = 12345;     ///< decimal digits, at most eight; read from the flash
    std::uint16_t firmware = 0x0100;  ///< bcdDevice
    bool sensors = false;             ///< plug in the model's sensors, too
    std::string frames_file;          ///< raw frames of the mode in use, repeated; empty: the numbered pattern

    bool jpeg = false;  ///< offers MJPEG in place of YUYV; frames_file is a JPEG, which every frame is

    bool only_smallest_mode() const { return link == Link::usb2 || model->old_firmware; }

    std::span<const Mode> offered_modes() const {
        return only_smallest_mode() ? std::span(modes).last(1) : std::span(modes);
    }
};

/// Frame interval in units of 100 ns, as UVC counts.
constexpr std::uint32_t interval_of_rate(int rate) {
    return static_cast<std::uint32_t>(10'000'000 / rate);
}

}  // namespace simulated_camera
