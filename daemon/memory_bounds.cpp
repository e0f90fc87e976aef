// SPDX-License-Identifier: Apache-2.0
#include "daemon/memory_bounds.h"

#include <algorithm>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>

#include "capture/recording/recorder.h"
#include "daemon/requests/trace_request.h"
#include "daemon/socket/client_places.h"
#include "daemon/socket/client_rules.h"
#include "daemon/socket/socket_server.h"
#include "proto/framing.h"

namespace disparityd::daemon {
namespace {

constexpr std::size_t kibibyte = 1024;
constexpr std::size_t mebibyte = 1024 * kibibyte;

/// Returns the bytes of all planes of a frame.
std::size_t frame_bytes(const StreamLayout& layout) {
    std::size_t bytes = 0;
    for (const v1::Product product : layout.products) {
        bytes += product_shape(layout, product).bytes();
    }
    return bytes;
}

/// Returns the bytes that a frame has at most after compression, which makes noise longer.
std::size_t encoded_bytes(std::size_t frame) {
    return frame + frame / 128 + mebibyte / 4;
}

/// Returns the bytes of a status that tells of so many clients.
std::size_t status_bytes(std::size_t clients) {
    constexpr std::size_t of_the_daemon = 64 * kibibyte;
    constexpr std::size_t of_a_client = 512;
    return std::min<std::size_t>(of_the_daemon + clients * of_a_client, proto::max_envelope_bytes);
}

/// Returns what one client makes the daemon hold.
std::size_t client_bytes(std::size_t frame, std::size_t clients) {
    constexpr std::size_t session = 192 * kibibyte;  // its objects, those of TLS
    // A message that arrives lies in a vector that has doubled, a request in another until it is answered.
    constexpr std::size_t messages = 3 * std::size_t{proto::max_client_envelope_bytes};
    const std::size_t answers = ClientRules::max_answer_bytes + 2 * status_bytes(clients);
    return session + messages + answers + 2 * encoded_bytes(frame);  // one on its way, one compressed behind it
}

/// Returns the most that the system keeps of what was written to one socket.
std::size_t socket_bytes(bool tcp) {
    std::ifstream file(tcp ? "/proc/sys/net/ipv4/tcp_wmem" : "/proc/sys/net/core/wmem_default");
    std::size_t most = 0;
    for (std::size_t number = 0; file >> number;) {
        most = number;  // that of TCP are three: min, default, max
    }
    return most;
}

/// Returns what all clients share.
std::size_t shared_bytes(std::size_t frame) {
    constexpr std::size_t zstd = 8 * mebibyte;
    constexpr std::size_t message_read = 4 * mebibyte;  // objects of the smallest parts that a message can have
    return 2 * encoded_bytes(frame) + zstd + message_read + TraceService::max_bytes;
}

std::size_t recording_bytes(const capture::SourceInfo& source) {
    const std::size_t frame = 2 * static_cast<std::size_t>(source.eye_width) * static_cast<std::size_t>(source.height) *
                              static_cast<std::size_t>(bytes_per_pixel(source.format));
    constexpr std::size_t at_work = 4;  // the encoder's picture and packet, which may be longer
    constexpr std::size_t cluster = 16 * mebibyte;
    return (capture::Recorder::default_buffers + at_work) * frame + cluster;
}

std::string megabytes(std::size_t bytes) {
    return fmt::format("{} MB", (bytes + 999'999) / 1'000'000);
}

}  // namespace

std::string MemoryBounds::text() const {
    std::string line = fmt::format("memory at most: {}: matching {}, frames {}", megabytes(all()), megabytes(engine),
                                   megabytes(frames));
    if (clients > 0) {
        line += fmt::format(", {} clients that read nothing {} and their sockets {}", places, megabytes(clients),
                            megabytes(system));
    }
    return recording > 0 ? line + ", a recording " + megabytes(recording) : line;
}

std::string MemoryBounds::warning(const base::MemoryRoom& room) const {
    const std::size_t later = all() - engine;
    if (room.bytes == SIZE_MAX || later <= room.bytes) {
        return {};
    }
    std::string line = fmt::format("{} has {} left, and this configuration may take {} more", room.where,
                                   megabytes(room.bytes), megabytes(later));
    const std::size_t of_clients = clients + system;
    const std::size_t others = later - of_clients;
    if (others < room.bytes && places > places_refused) {
        const std::size_t fit = (room.bytes - others) / (of_clients / places);
        if (fit > places_refused) {
            return line + fmt::format(": with [socket] max_clients = {} it would not", fit - places_refused);
        }
    }
    return line + ": choose fewer slots, fewer clients or a smaller image";
}

MemoryBounds serving_memory(const Config& config, const StreamLayout& layout, const capture::SourceInfo& source) {
    const std::size_t frame = frame_bytes(layout);
    MemoryBounds bounds;
    if (config.shared_memory.enabled) {
        bounds.frames += static_cast<std::size_t>(config.shared_memory.slots) * (frame + 64 * kibibyte);
    }
    if (!config.socket.tcp.empty() || !config.socket.unix_path.empty()) {
        bounds.places_refused = ClientPlaces::max_refused;
        bounds.places = static_cast<std::size_t>(config.socket.max_clients) + bounds.places_refused;
        bounds.frames +=
            (static_cast<std::size_t>(config.socket.client_queue) + SocketServer::copies_on_the_way) * frame;
        bounds.clients = bounds.places * client_bytes(frame, bounds.places) + shared_bytes(frame);
        bounds.system = bounds.places * socket_bytes(!config.socket.tcp.empty());
    }
    if (config.record.enabled) {
        bounds.recording = recording_bytes(source);
    }
    return bounds;
}

}  // namespace disparityd::daemon
