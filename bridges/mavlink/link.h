// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace disparityd::mavlink {

/// Takes messages to the autopilot. It opens itself when it is used, and again after a failure, at first after half a
/// second, later every 8 s. It throws nothing that a network or a device does; problem() says it. One thread uses it.
class Link {
public:
    using Clock = std::chrono::steady_clock;

    virtual ~Link() = default;
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;

    /// Opens it if it is not open and was not tried a short time ago. Returns whether it is open.
    bool open();

    /// Sends a message whole; waits for room at most until the deadline. Returns false when it was not sent: the link
    /// is not open, had no room in time (what waits in the system is thrown away then) or has just failed.
    bool send(std::span<const std::uint8_t> bytes, Clock::time_point deadline);

    /// Throws away what waits in the system although, by the link's speed, it should have left a while ago: nobody
    /// reads, and whoever does later would take it for new. Call it several times a second. Returns whether there was
    /// nothing that may still be on its way.
    bool forget_old();

    /// Returns how long so many bytes need until the last of them has left, behind those that wait already.
    virtual std::chrono::nanoseconds time_for(std::size_t bytes) const = 0;

    /// Reads what has come and gives it to `take`, in order; empty: it is thrown away.
    void drain(const std::function<void(std::span<const std::uint8_t> bytes)>& take = {});

    /// Returns one line: why nothing or not everything is sent, and what to do; empty when all is well.
    const std::string& problem() const { return problem_; }

    /// Returns what the user named: "udp 127.0.0.1:14550".
    virtual std::string name() const = 0;

protected:
    Link() = default;

    virtual void open_descriptor() = 0;  ///< throws boost::system::system_error
    virtual void close_descriptor() = 0;
    virtual int descriptor() const = 0;
    virtual bool outlives(int error) const = 0;  ///< whether it goes on as it is after this errno
    virtual void forget_waiting() const {}       ///< throws away what waits in the system
    virtual std::chrono::nanoseconds time_of(std::size_t /*bytes*/) const { return {}; }  ///< at the link's speed
    virtual std::string advice() const = 0;  ///< what to do when it cannot be used

    /// So long after it should have left, what waits is old.
    static constexpr std::chrono::milliseconds grace{100};

    /// When, by the link's speed, all that was sent will have left.
    Clock::time_point empty_at() const { return empty_at_; }

private:
    bool write_all(std::span<const std::uint8_t> bytes, Clock::time_point deadline);
    void fail(const std::string& reason);

    bool is_open_ = false;
    std::string problem_;
    std::chrono::milliseconds pause_{};
    Clock::time_point next_try_{};
    Clock::time_point empty_at_{};
};

/// Returns a link that sends each message as one datagram. Nobody needs to listen. `host` is a name or an address.
std::unique_ptr<Link> udp_link(const std::string& host, std::uint16_t port);

/// Whether serial_link() takes the speed, in bits per second.
bool is_baud_rate(unsigned baud);

/// Returns a link to a serial device: 8 data bits, no parity, one stop bit, no flow control. `baud` is one of
/// is_baud_rate(), or else the link never opens.
std::unique_ptr<Link> serial_link(const std::string& device, unsigned baud);

}  // namespace disparityd::mavlink
