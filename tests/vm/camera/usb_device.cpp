// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/usb_device.h"

#include <algorithm>
#include <cerrno>

#include "tests/vm/camera/descriptors.h"

namespace simulated_camera {
namespace {

constexpr std::uint8_t to_endpoint = 2;
constexpr std::uint16_t endpoint_halt = 0;
constexpr std::uint8_t power_mode_selector = 1;
constexpr std::uint8_t error_code_selector = 2;

std::uint32_t isochronous_endpoint(const CameraOptions& camera) {
    return camera.transfer == Transfer::isochronous ? video_endpoint & 0x0fU : 0;
}

}  // namespace

ControlAnswer PictureControls::read(const Control& control, std::uint8_t request) {
    Bytes bytes;
    switch (request) {
        case uvc_request::get_cur: append_little_endian(bytes, control.now, control.length); break;
        case uvc_request::get_min: append_little_endian(bytes, control.lowest, control.length); break;
        case uvc_request::get_max: append_little_endian(bytes, control.highest, control.length); break;
        case uvc_request::get_res: append_little_endian(bytes, control.step, control.length); break;
        case uvc_request::get_def: append_little_endian(bytes, control.usual, control.length); break;
        case uvc_request::get_len: append_little_endian(bytes, control.length, 2); break;
        case uvc_request::get_info: bytes = {readable_and_writable}; break;
        default: return std::nullopt;
    }
    return bytes;
}

ControlAnswer PictureControls::answer(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    const auto control = std::find_if(controls_.begin(), controls_.end(),
                                      [&](const Control& each) { return each.selector == setup.value_high(); });
    if (control == controls_.end()) {
        return std::nullopt;
    }
    if (setup.request != uvc_request::set_cur) {
        return read(*control, setup.request);
    }
    if (data.size() != control->length) {
        return std::nullopt;
    }
    const std::uint32_t value = get_little_endian(data, 0, control->length);
    control->now = static_cast<std::uint16_t>(std::clamp<std::uint32_t>(value, control->lowest, control->highest));
    return Bytes();
}

UsbDevice::UsbDevice(const CameraOptions& camera, FileDescriptor socket, FrameFeed& feed, Faults& faults,
                     StreamCounters& counters)
    : camera_(camera),
      faults_(faults),
      host_(std::move(socket), isochronous_endpoint(camera)),
      extension_unit_(camera),
      settings_(camera),
      stream_(feed, faults, counters, host_) {}

bool UsbDevice::handle_message() {
    auto message = host_.receive();
    if (!message) {
        return false;
    }
    if (auto* submission = std::get_if<Submission>(&*message)) {
        handle(std::move(*submission));
    } else {
        handle(std::get<Withdrawal>(*message));
    }
    return true;
}

void UsbDevice::handle(Submission submission) {
    if (submission.endpoint != 0) {
        stream_.submit(std::move(submission));
        return;
    }
    const SetupPacket& setup = submission.setup;
    ControlAnswer answer = control(setup, submission.data);
    if (!answer) {
        host_.complete(submission.sequence, -EPIPE, {});
    } else if (setup.to_host()) {
        const std::size_t length = std::min<std::size_t>(answer->size(), setup.length);
        host_.complete(submission.sequence, 0, std::span(*answer).first(length));
    } else {
        host_.complete_taken(submission.sequence, submission.length);
    }
}

void UsbDevice::handle(const Withdrawal& withdrawal) {
    host_.complete_withdrawal(withdrawal.sequence, stream_.withdraw(withdrawal.submission) ? -ECONNRESET : 0);
}

ControlAnswer UsbDevice::control(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    return setup.is_class() ? class_request(setup, data) : standard_request(setup);
}

ControlAnswer UsbDevice::standard_request(const SetupPacket& setup) {
    switch (setup.request) {
        case get_descriptor: return find_descriptor(camera_, setup.value_high(), setup.value_low());
        case get_status: return Bytes{0, 0};
        case get_configuration: return Bytes{1};
        case get_interface: return Bytes{static_cast<std::uint8_t>(stream_.running() ? 1 : 0)};
        case set_configuration:
            // After its first time only a reset of the port brings it again.
            stop_stream();
            end_freeze(FrozenUntil::usb_reset);
            return Bytes();
        case set_interface:
            if (setup.index == streaming_interface && camera_.transfer == Transfer::isochronous) {
                setup.value == 1 ? start_stream() : stop_stream();
            }
            return Bytes();
        case clear_feature:
            // How a host stops a bulk stream.
            if (setup.recipient() == to_endpoint && setup.value == endpoint_halt) {
                stop_stream();
            }
            return Bytes();
        case set_feature:
        case set_exit_latency:
        case set_isochronous_delay: return Bytes();
        default: return std::nullopt;
    }
}

ControlAnswer UsbDevice::class_request(const SetupPacket& setup, std::span<const std::uint8_t> data) {
    if (setup.index_low() == streaming_interface) {
        ControlAnswer answer = settings_.answer(setup, data);
        // A bulk stream has no other sign that it begins.
        if (answer && is_commit(setup) && camera_.transfer == Transfer::bulk) {
            start_stream();
        }
        return answer;
    }
    switch (setup.index_high()) {
        case 0:
            if (setup.value_high() != power_mode_selector && setup.value_high() != error_code_selector) {
                return std::nullopt;
            }
            return Bytes{static_cast<std::uint8_t>(setup.request == uvc_request::get_info ? 1 : 0)};
        case unit_id::processing: return picture_controls_.answer(setup, data);
        case unit_id::extension: return extension_unit_.answer(setup, data);
        default: return std::nullopt;
    }
}

void UsbDevice::start_stream() {
    end_freeze(FrozenUntil::stream_restart);
    stream_.start(settings_.mode(), bulk_payload_bytes(camera_.link));
}

void UsbDevice::stop_stream() {
    stream_.stop();
}

void UsbDevice::end_freeze(FrozenUntil event) {
    if (faults_.frozen != FrozenUntil::thaw && faults_.frozen <= event) {
        faults_.frozen = FrozenUntil::not_frozen;
    }
}

}  // namespace simulated_camera
