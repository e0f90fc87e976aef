// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace disparityd::daemon {

/// Limits how many clients are served at the same time, in total and over TCP.
class ClientPlaces {
public:
    /// Connections beyond the limit that get an Error at the same time; further ones are closed without one.
    static constexpr std::size_t max_refused = 16;

    /// File descriptors that clients may not use. The daemon has 13 open with a rendered scene and no client; the
    /// others are for a camera and its sensors (twice during a reload), a recording, and the driver of a GPU.
    static constexpr std::size_t reserved_descriptors = 128;

    /// `wanted`: as configured, at least 1. `descriptors`: how many the process may have open. If both TCP and the Unix
    /// socket are served, a quarter of the places, at least one, is reserved for the Unix socket; TCP keeps at least
    /// one.
    ClientPlaces(std::size_t wanted, std::size_t descriptors, bool serves_tcp, bool serves_unix);

    std::size_t all() const { return all_; }
    std::size_t for_tcp() const { return all_ - kept_; }

    /// Returns whether one more client is served when `taken` are connected, `taken_by_tcp` of them over TCP.
    bool free_for(bool local, std::size_t taken, std::size_t taken_by_tcp) const {
        return taken < all_ && (local || taken_by_tcp < for_tcp());
    }

    /// Returns the Error for a client that is not served.
    std::string refusal(bool local) const;

    /// Returns one line for people if fewer clients are served than configured, else an empty text.
    std::string notice() const;

private:
    std::size_t wanted_;
    std::size_t descriptors_;
    std::size_t all_;
    std::size_t kept_;  ///< for the Unix socket
};

}  // namespace disparityd::daemon
