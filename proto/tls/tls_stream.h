// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "proto/tls/tls_context.h"

namespace disparityd::proto {

/// One end of a TLS connection over a connected socket that does not block. No call waits, and none raises SIGPIPE. One
/// thread at a time.
class TlsStream {
public:
    /// wants_read, wants_write: call again once the socket is readable, or writable. closed: the connection has ended.
    /// failed: problem() says why; the connection cannot go on.
    enum class Outcome { done, wants_read, wants_write, closed, failed };
    enum class End { client, server };
    /// Whether the same call is to be made again later.
    static bool is_wanting(Outcome outcome) {
        return outcome == Outcome::wants_read || outcome == Outcome::wants_write;
    }

    /// The socket stays the caller's, and open until leave_socket(). Throws std::bad_alloc.
    TlsStream(const TlsContext& context, int socket, End end);
    ~TlsStream();
    TlsStream(const TlsStream&) = delete;
    TlsStream& operator=(const TlsStream&) = delete;

    /// Of a client, before the handshake: the server's certificate must be for this name or address.
    void expect_server(const std::string& name);

    /// Agrees on keys; `done` before anything else is called.
    Outcome handshake();

    /// Reads the bytes that are there, at least one.
    Outcome read(std::span<std::uint8_t> bytes, std::size_t& received);

    /// Writes a part of the bytes, one record of 16 KiB at most, and sets `sent`. After wants_read or wants_write the
    /// next call must have the same bytes in front, anywhere in memory.
    Outcome write(std::span<const std::uint8_t> bytes, std::size_t& sent);

    /// Tells the other end that nothing follows, if the socket takes that at once.
    void end_output() noexcept;

    /// Comes before the socket is closed: its number may soon be that of another file. Every later call returns
    /// `closed` or what had arrived before.
    void leave_socket() noexcept;

    /// Returns one line: why the last call failed.
    const std::string& problem() const { return problem_; }

    /// Returns the common name in the other end's certificate, which was checked; nothing where it has none.
    std::optional<std::string> peer_name() const;

    /// Of a server, after the handshake: returns whether the client's certificate would be taken with this context,
    /// too.
    bool would_be_taken_by(const TlsContext& context) const;

    /// The largest part that write() takes at once.
    static constexpr std::size_t record_bytes = 16384;

private:
    Outcome outcome_of(int result);

    std::unique_ptr<SSL, decltype(&SSL_free)> ssl_;
    std::string problem_;
};

/// Returns whether a connection that begins with these two bytes begins with TLS. The protocol without TLS begins with
/// the length of a Hello, which is never so long.
inline bool begins_with_tls(std::span<const std::uint8_t, 2> bytes) {
    return bytes[0] == 0x16 && bytes[1] == 0x03;
}

}  // namespace disparityd::proto
