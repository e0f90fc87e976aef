// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "tests/vm/camera/file_descriptor.h"
#include "tests/vm/camera/usb_request.h"

namespace simulated_camera {

/// A transfer that the host asks for.
struct Submission {
    std::uint32_t sequence;
    bool to_host;
    std::uint32_t endpoint;
    std::uint32_t length;                       ///< room for data, bytes
    SetupPacket setup;                          ///< of control transfers
    Bytes data;                                 ///< of transfers to the device
    std::vector<std::uint32_t> packet_lengths;  ///< of isochronous transfers
};

/// The host takes a transfer back.
struct Withdrawal {
    std::uint32_t sequence;
    std::uint32_t submission;  ///< sequence of the transfer
};

using HostMessage = std::variant<Submission, Withdrawal>;

/// The device's end of the USB/IP protocol (Documentation/usb/usbip_protocol.rst of Linux), after the import of a
/// device: the host sends submissions, each is completed once. Blocking; for one thread.
class UsbIpConnection {
public:
    /// `isochronous_endpoint`: submissions to it carry packets; 0 for none.
    UsbIpConnection(FileDescriptor socket, std::uint32_t isochronous_endpoint);

    int socket() const { return socket_.get(); }

    /// Waits for a message; nothing once the host has closed.
    std::optional<HostMessage> receive();

    /// Status: 0 or a negative errno.
    void complete(std::uint32_t sequence, int status, std::span<const std::uint8_t> data);
    /// For transfers to the device.
    void complete_taken(std::uint32_t sequence, std::uint32_t length);
    /// `data` holds what the packets got, without gaps; `got` is how much each of them did.
    void complete_packets(std::uint32_t sequence, std::span<const std::uint8_t> data,
                          std::span<const std::uint32_t> packet_lengths, std::span<const std::uint32_t> got);
    void complete_withdrawal(std::uint32_t sequence, int status);

private:
    bool receive_exactly(std::span<std::uint8_t> bytes);
    std::optional<Submission> receive_submission(std::span<const std::uint8_t> header);
    void send(std::span<const std::uint8_t> header, std::span<const std::uint8_t> data);

    FileDescriptor socket_;
    std::uint32_t isochronous_endpoint_;
};

}  // namespace simulated_camera
