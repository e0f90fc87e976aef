// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/usbip.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <sys/socket.h>

namespace simulated_camera {

namespace {

constexpr std::size_t header_bytes = 48;
constexpr std::size_t packet_descriptor_bytes = 16;
// Larger than any transfer of uvcvideo: beyond it, the two sides have lost each other.
constexpr std::uint32_t transfer_limit = 64U << 20U;
constexpr std::uint32_t packets_limit = 1024;

enum Command : std::uint32_t { submit = 1, unlink = 2, submit_done = 3, unlink_done = 4 };

// Places in a header; all numbers have four bytes, most significant first.
constexpr std::size_t command_at = 0;
constexpr std::size_t sequence_at = 4;
constexpr std::size_t direction_at = 12;
constexpr std::size_t endpoint_at = 16;
constexpr std::size_t length_at = 24;
constexpr std::size_t packets_at = 32;
constexpr std::size_t setup_at = 40;
constexpr std::size_t withdrawn_at = 20;
constexpr std::size_t status_at = 20;
constexpr std::size_t packet_length_at = 4;
constexpr std::size_t packet_got_at = 8;

void put_big_endian(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
    }
}

using Header = std::array<std::uint8_t, header_bytes>;

Header completion(Command command, std::uint32_t sequence, int status, std::size_t length) {
    Header header{};
    put_big_endian(header, command_at, command);
    put_big_endian(header, sequence_at, sequence);
    put_big_endian(header, status_at, static_cast<std::uint32_t>(status));
    put_big_endian(header, length_at, static_cast<std::uint32_t>(length));
    return header;
}

SetupPacket setup_packet(std::span<const std::uint8_t> bytes) {
    const auto word = [&](std::size_t at) { return static_cast<std::uint16_t>(get_little_endian(bytes, at, 2)); };
    return {bytes[0], bytes[1], word(2), word(4), word(6)};
}

}  // namespace

UsbIpConnection::UsbIpConnection(FileDescriptor socket, std::uint32_t isochronous_endpoint)
    : socket_(std::move(socket)), isochronous_endpoint_(isochronous_endpoint) {}

bool UsbIpConnection::receive_exactly(std::span<std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t got = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

std::optional<Submission> UsbIpConnection::receive_submission(std::span<const std::uint8_t> header) {
    Submission submission{};
    submission.sequence = get_big_endian(header, sequence_at, 4);
    submission.to_host = get_big_endian(header, direction_at, 4) == 1;
    submission.endpoint = get_big_endian(header, endpoint_at, 4);
    submission.length = get_big_endian(header, length_at, 4);
    submission.setup = setup_packet(header.subspan(setup_at));
    if (submission.length > transfer_limit) {
        return std::nullopt;
    }
    if (!submission.to_host) {
        submission.data.resize(submission.length);
        if (!receive_exactly(submission.data)) {
            return std::nullopt;
        }
    }
    if (isochronous_endpoint_ != 0 && submission.endpoint == isochronous_endpoint_) {
        const std::uint32_t packets = get_big_endian(header, packets_at, 4);
        Bytes descriptors(packet_descriptor_bytes * std::min(packets, packets_limit));
        if (packets > packets_limit || !receive_exactly(descriptors)) {
            return std::nullopt;
        }
        for (std::size_t at = 0; at < descriptors.size(); at += packet_descriptor_bytes) {
            submission.packet_lengths.push_back(get_big_endian(descriptors, at + packet_length_at, 4));
        }
    }
    return submission;
}

std::optional<HostMessage> UsbIpConnection::receive() {
    Header header;
    if (!receive_exactly(header)) {
        return std::nullopt;
    }
    switch (get_big_endian(header, command_at, 4)) {
        case submit: {
            auto submission = receive_submission(header);
            return submission ? std::optional<HostMessage>(std::move(*submission)) : std::nullopt;
        }
        case unlink: return Withdrawal{get_big_endian(header, sequence_at, 4), get_big_endian(header, withdrawn_at, 4)};
        default: return std::nullopt;
    }
}

// A host that has gone shows in the next receive().
void UsbIpConnection::send(std::span<const std::uint8_t> header, std::span<const std::uint8_t> data) {
    for (std::span<const std::uint8_t> part : {header, data}) {
        while (!part.empty()) {
            const ssize_t sent = ::send(socket_.get(), part.data(), part.size(), MSG_NOSIGNAL);
            if (sent < 0 && errno == EINTR) {
                continue;
            }
            if (sent < 0) {
                return;
            }
            part = part.subspan(static_cast<std::size_t>(sent));
        }
    }
}

void UsbIpConnection::complete(std::uint32_t sequence, int status, std::span<const std::uint8_t> data) {
    send(completion(submit_done, sequence, status, data.size()), data);
}

void UsbIpConnection::complete_taken(std::uint32_t sequence, std::uint32_t length) {
    send(completion(submit_done, sequence, 0, length), {});
}

void UsbIpConnection::complete_packets(std::uint32_t sequence, std::span<const std::uint8_t> data,
                                       std::span<const std::uint32_t> packet_lengths,
                                       std::span<const std::uint32_t> got) {
    Header header = completion(submit_done, sequence, 0, data.size());
    put_big_endian(header, packets_at, static_cast<std::uint32_t>(packet_lengths.size()));
    Bytes tail(packet_descriptor_bytes * packet_lengths.size());
    std::uint32_t offset = 0;
    for (std::size_t i = 0; i < packet_lengths.size(); ++i) {
        const std::span<std::uint8_t> descriptor = std::span(tail).subspan(packet_descriptor_bytes * i);
        put_big_endian(descriptor, 0, offset);
        put_big_endian(descriptor, packet_length_at, packet_lengths[i]);
        put_big_endian(descriptor, packet_got_at, got[i]);
        offset += packet_lengths[i];
    }
    send(header, data);
    send(tail, {});
}

void UsbIpConnection::complete_withdrawal(std::uint32_t sequence, int status) {
    send(completion(unlink_done, sequence, status, 0), {});
}

}  // namespace simulated_camera
