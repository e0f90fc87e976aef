// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/descriptors.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace simulated_camera {

namespace {

enum DescriptorType : std::uint8_t {
    device = 1,
    configuration = 2,
    string = 3,
    interface = 4,
    endpoint = 5,
    device_qualifier = 6,
    interface_association = 11,
    capabilities = 15,
    device_capability = 16,
    class_interface = 0x24,
    endpoint_companion = 0x30
};

enum StringIndex : std::uint8_t { languages = 0, manufacturer = 1, product = 2, serial_text = 3 };

constexpr std::uint8_t video_class = 0x0e;
constexpr std::uint8_t video_control = 1;
constexpr std::uint8_t video_streaming = 2;
constexpr std::uint8_t video_collection = 3;
// Brightness, contrast, hue, saturation, sharpness, gamma, white balance temperature and its automatic.
constexpr std::uint32_t processing_controls = 0x107f;

// A descriptor is written from its fields; its length goes in front.
class Descriptor {
public:
    explicit Descriptor(std::uint8_t type) {
        bytes_.reserve(255);  // its length is one byte
        bytes_.push_back(0);
        bytes_.push_back(type);
    }

    Descriptor& byte(std::uint32_t value) { return number(value, 1); }
    Descriptor& word(std::uint32_t value) { return number(value, 2); }
    Descriptor& dword(std::uint32_t value) { return number(value, 4); }
    Descriptor& number(std::uint32_t value, int count) {
        append_little_endian(bytes_, value, count);
        return *this;
    }
    Descriptor& text(std::string_view characters) {
        for (const char c : characters) {
            byte(static_cast<std::uint8_t>(c));
        }
        return *this;
    }
    /// Gives the bytes away: nothing is added after it.
    Bytes done() {
        bytes_[0] = static_cast<std::uint8_t>(bytes_.size());
        return std::move(bytes_);
    }

private:
    Bytes bytes_;
};

// Joins descriptors and writes how long all of them are, two bytes at `length_at` of the first.
Bytes with_total_length(std::size_t length_at, std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts) {
        append(all, part);
    }
    put_little_endian(all, length_at, static_cast<std::uint32_t>(all.size()), 2);
    return all;
}

Bytes interface_descriptor(std::uint8_t number, std::uint8_t alternate, std::uint8_t endpoints, std::uint8_t subclass) {
    return Descriptor(interface)
        .byte(number)
        .byte(alternate)
        .byte(endpoints)
        .byte(video_class)
        .byte(subclass)
        .byte(0)
        .byte(0)
        .done();
}

Bytes control_units() {
    return with_total_length(5, {Descriptor(class_interface)
                                     .byte(1)
                                     .word(0x0110)
                                     .word(0)
                                     .dword(48'000'000)
                                     .byte(1)
                                     .byte(streaming_interface)
                                     .done(),
                                 Descriptor(class_interface)
                                     .byte(2)
                                     .byte(unit_id::camera_terminal)
                                     .word(0x0201)
                                     .byte(0)
                                     .byte(0)
                                     .word(0)
                                     .word(0)
                                     .word(0)
                                     .byte(3)
                                     .number(0, 3)
                                     .done(),
                                 Descriptor(class_interface)
                                     .byte(5)
                                     .byte(unit_id::processing)
                                     .byte(unit_id::camera_terminal)
                                     .word(0)
                                     .byte(3)
                                     .number(processing_controls, 3)
                                     .byte(0)
                                     .byte(0)
                                     .done(),
                                 Descriptor(class_interface)
                                     .byte(6)
                                     .byte(unit_id::extension)
                                     .text("simulated-camera")
                                     .byte(1)
                                     .byte(1)
                                     .byte(unit_id::processing)
                                     .byte(1)
                                     .byte(0x02)
                                     .byte(0)
                                     .done(),
                                 Descriptor(class_interface)
                                     .byte(3)
                                     .byte(unit_id::output_terminal)
                                     .word(0x0101)
                                     .byte(0)
                                     .byte(unit_id::extension)
                                     .byte(0)
                                     .done()});
}

Bytes frame_descriptor(std::uint8_t index, const Mode& mode, bool jpeg) {
    const auto rates =
        static_cast<std::uint8_t>(std::count_if(mode.rates.begin(), mode.rates.end(), [](int r) { return r > 0; }));
    const auto bits_per_second = [&](int rate) {
        return static_cast<std::uint32_t>(
            std::min<std::uint64_t>(0xffff'ffff, 8ULL * mode.frame_bytes() * static_cast<unsigned>(rate)));
    };
    Descriptor frame(class_interface);
    frame.byte(jpeg ? 7 : 5).byte(index).byte(0).word(mode.width).word(mode.height);
    frame.dword(bits_per_second(mode.rates[rates - 1U]))
        .dword(bits_per_second(mode.rates[0]))
        .dword(mode.frame_bytes());
    frame.dword(interval_of_rate(mode.rates[0])).byte(rates);
    for (std::uint8_t i = 0; i < rates; ++i) {
        frame.dword(interval_of_rate(mode.rates[i]));
    }
    return frame.done();
}

Bytes video_formats(const CameraOptions& camera) {
    const auto offered = camera.offered_modes();
    Bytes frames;
    for (std::size_t i = 0; i < offered.size(); ++i) {
        append(frames, frame_descriptor(static_cast<std::uint8_t>(i + 1), offered[i], camera.jpeg));
    }
    Descriptor format(class_interface);
    if (camera.jpeg) {
        format.byte(6).byte(1).byte(static_cast<std::uint8_t>(offered.size())).byte(1);
    } else {
        // The identifier of YUY2: its four letters, then the end that such identifiers of media types share.
        format.byte(4).byte(1).byte(static_cast<std::uint8_t>(offered.size())).text("YUY2");
        for (const int value : {0x00, 0x00, 0x10, 0x00, 0x80, 0x00, 0x00, 0xaa, 0x00, 0x38, 0x9b, 0x71}) {
            format.byte(static_cast<std::uint8_t>(value));
        }
        format.byte(16);
    }
    format.byte(1).byte(0).byte(0).byte(0).byte(0);
    return with_total_length(
        4, {Descriptor(class_interface)
                .byte(1)
                .byte(1)
                .word(0)
                .byte(video_endpoint)
                .byte(0)
                .byte(unit_id::output_terminal)
                .byte(0)
                .byte(0)
                .byte(0)
                .byte(1)
                .byte(0)
                .done(),
            format.done(), frames, Descriptor(class_interface).byte(0x0d).byte(1).byte(1).byte(4).done()});
}

Bytes video_endpoint_descriptor(const CameraOptions& camera) {
    const bool usb3 = camera.link == Link::usb3;
    Descriptor companion(endpoint_companion);
    Descriptor end(endpoint);
    end.byte(video_endpoint);
    if (camera.transfer == Transfer::isochronous) {
        end.byte(0x05).word(usb3 ? 1024 : 0x1400).byte(1);  // USB 2: three packets of 1024 bytes
        companion.byte(15).byte(2).word(bytes_per_interval(camera.link));
    } else {
        end.byte(0x02).word(usb3 ? 1024 : 512).byte(0);
        companion.byte(15).byte(0).word(0);
    }
    Bytes bytes = end.done();
    if (usb3) {
        append(bytes, companion.done());
    }
    return bytes;
}

// An isochronous camera is silent in its first alternate setting and sends in the second; a bulk camera has only one.
Bytes streaming_descriptors(const CameraOptions& camera) {
    const bool bulk = camera.transfer == Transfer::bulk;
    Bytes all = interface_descriptor(streaming_interface, 0, bulk ? 1 : 0, video_streaming);
    append(all, video_formats(camera));
    if (!bulk) {
        append(all, interface_descriptor(streaming_interface, 1, 1, video_streaming));
    }
    append(all, video_endpoint_descriptor(camera));
    return all;
}

Bytes string_descriptor(std::string_view characters) {
    Descriptor descriptor(string);
    for (const char c : characters) {
        descriptor.word(static_cast<std::uint8_t>(c));
    }
    return descriptor.done();
}

ControlAnswer find_string(const CameraOptions& camera, std::uint8_t index) {
    switch (index) {
        case languages: return Descriptor(string).word(0x0409).done();
        case manufacturer: return string_descriptor("Simulated");
        case product: return string_descriptor(camera.model->product);
        // The same in every camera: only the flash tells two of them apart.
        case serial_text: return string_descriptor("OV0001");
        default: return std::nullopt;
    }
}

}  // namespace

std::uint32_t bytes_per_interval(Link link) {
    return link == Link::usb3 ? 48 * 1024 : 3 * 1024;
}

std::uint32_t bulk_payload_bytes(Link link) {
    return link == Link::usb3 ? 32 * 1024 : 16 * 1024;
}

Bytes device_descriptor(const CameraOptions& camera) {
    const bool usb3 = camera.link == Link::usb3;
    return Descriptor(device)
        .word(usb3 ? 0x0310 : 0x0200)
        .byte(0xef)
        .byte(2)
        .byte(1)
        .byte(usb3 ? 9 : 64)
        .word(vendor_id)
        .word(camera.model->product_id)
        .word(camera.firmware)
        .byte(manufacturer)
        .byte(product)
        .byte(serial_text)
        .byte(1)
        .done();
}

Bytes configuration_descriptor(const CameraOptions& camera) {
    const bool usb3 = camera.link == Link::usb3;
    return with_total_length(
        2,
        {Descriptor(configuration).word(0).byte(2).byte(1).byte(0).byte(0x80).byte(usb3 ? 62 : 250).done(),
         Descriptor(interface_association)
             .byte(control_interface)
             .byte(2)
             .byte(video_class)
             .byte(video_collection)
             .byte(0)
             .byte(product)
             .done(),
         interface_descriptor(control_interface, 0, 0, video_control), control_units(), streaming_descriptors(camera)});
}

Bytes capabilities_descriptor() {
    return with_total_length(
        2, {Descriptor(capabilities).word(0).byte(2).done(), Descriptor(device_capability).byte(2).dword(2).done(),
            Descriptor(device_capability).byte(3).byte(0).word(0x0e).byte(1).byte(10).word(0x7ff).done()});
}

Bytes device_qualifier_descriptor() {
    return Descriptor(device_qualifier).word(0x0200).byte(0xef).byte(2).byte(1).byte(64).byte(1).byte(0).done();
}

ControlAnswer find_descriptor(const CameraOptions& camera, std::uint8_t type, std::uint8_t index) {
    const bool usb3 = camera.link == Link::usb3;
    switch (type) {
        case device: return device_descriptor(camera);
        case configuration: return configuration_descriptor(camera);
        case string: return find_string(camera, index);
        case device_qualifier: return usb3 ? ControlAnswer() : device_qualifier_descriptor();
        case capabilities: return usb3 ? ControlAnswer(capabilities_descriptor()) : std::nullopt;
        default: return std::nullopt;
    }
}

}  // namespace simulated_camera
