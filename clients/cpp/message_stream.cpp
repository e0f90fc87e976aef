// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/message_stream.h"

#include <algorithm>
#include <stdexcept>

#include <zstd.h>

namespace disparity {
namespace {

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;

/// The buffer grows by this much at a time, beyond the bytes that have arrived.
constexpr std::uint64_t growth = 1 << 20;

}  // namespace

MessageStream::Outcome MessageStream::fill(std::vector<std::uint8_t>& buffer, std::uint64_t wanted, Deadline deadline) {
    while (filled_ < wanted) {
        if (buffer.size() == filled_) {
            buffer.resize(std::min(wanted, std::max(buffer.capacity(), filled_ + std::max(filled_, growth))));
        }
        const std::size_t room = std::min<std::size_t>(buffer.size(), wanted) - filled_;
        std::size_t received = 0;
        const Outcome outcome = transport_.receive({buffer.data() + filled_, room}, received, deadline);
        if (outcome != Outcome::done) {
            return outcome;
        }
        filled_ += received;
    }
    buffer.resize(wanted);
    return Outcome::done;
}

void MessageStream::check_payload() const {
    const std::uint64_t announced = envelope_.payload_bytes();
    if (announced > proto::max_payload_bytes) {
        throw std::invalid_argument("payload of " + std::to_string(announced) + " bytes announced, allowed " +
                                    std::to_string(proto::max_payload_bytes));
    }
    if (!envelope_.has_frame()) {
        return;
    }
    std::uint64_t left = announced;
    std::uint64_t raw_left = proto::max_payload_bytes;
    for (const v1::PlaneInfo& plane : envelope_.frame().planes()) {
        const std::uint64_t raw = proto::raw_plane_bytes(plane);
        const bool zstd = plane.encoding() == v1::ZSTD;
        if (!zstd && plane.encoding() != v1::RAW) {
            throw std::invalid_argument("plane with unknown encoding " + std::to_string(plane.encoding()));
        }
        const std::uint64_t most = zstd ? ZSTD_compressBound(raw) : raw;
        if (plane.payload_bytes() > left || raw > raw_left || plane.payload_bytes() > most ||
            (!zstd && plane.payload_bytes() != raw)) {
            throw std::invalid_argument("plane of " + std::to_string(plane.width()) + " x " +
                                        std::to_string(plane.height()) + " pixels announced with " +
                                        std::to_string(plane.payload_bytes()) + " of " + std::to_string(announced) +
                                        " payload bytes");
        }
        left -= plane.payload_bytes();
        raw_left -= raw;
    }
    if (left != 0) {
        throw std::invalid_argument("payload has " + std::to_string(left) + " bytes more than its planes");
    }
}

MessageStream::Outcome MessageStream::receive(Deadline deadline) {
    try {
        while (true) {
            const bool payload = part_ == Part::payload;
            const std::uint64_t wanted = payload ? envelope_.payload_bytes() : head_wanted_;
            if (const Outcome outcome = fill(payload ? payload_ : head_, wanted, deadline); outcome != Outcome::done) {
                return outcome;
            }
            filled_ = 0;
            switch (part_) {
                case Part::length:
                    head_wanted_ =
                        proto::decode_length(std::span<const std::uint8_t, proto::length_bytes>(head_.data(), 4));
                    part_ = Part::envelope;
                    break;
                case Part::envelope:
                    proto::decode(head_, envelope_);
                    check_payload();
                    part_ = Part::payload;
                    break;
                case Part::payload:
                    part_ = Part::length;
                    head_wanted_ = proto::length_bytes;
                    return Outcome::done;
            }
        }
    } catch (const std::invalid_argument&) {
        transport_.close();
        throw;
    }
}

MessageStream::Outcome MessageStream::send(const v1::Envelope& envelope, Deadline deadline) {
    proto::encode(envelope, out_);
    const Outcome outcome = transport_.send(out_, deadline);
    if (outcome == Outcome::timeout) {
        transport_.close();
    }
    return outcome;
}

}  // namespace disparity
