// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/serial_port.hpp>
#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

namespace disparityd::mavlink {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds first_pause{500};
constexpr std::chrono::milliseconds longest_pause{8000};

/// Waits until the descriptor takes bytes. Returns false when the deadline has passed.
bool wait_for_room(int fd, Link::Clock::time_point deadline) {
    while (true) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Link::Clock::now()).count();
        pollfd waiting{fd, POLLOUT, 0};
        const int ready = ::poll(&waiting, 1, static_cast<int>(std::clamp<long>(left, 0, 1000)));
        if (ready > 0) {
            return true;  // or the device has gone, which writing will tell
        }
        if (left <= 0) {
            return false;
        }
    }
}

class UdpLink : public Link {
public:
    UdpLink(std::string host, std::uint16_t port) : host_(std::move(host)), port_(port) {}

    /// A datagram leaves at once, or, while the network is away, waits in the system behind those before it, which
    /// cannot be taken back: no more go there.
    std::chrono::nanoseconds time_for(std::size_t /*bytes*/) const override {
        int waiting = 0;
        const bool stuck =
            ::ioctl(descriptor(), SIOCOUTQ, &waiting) == 0 && waiting > 0 && Clock::now() > empty_at() + grace;
        return stuck ? std::chrono::hours(1) : std::chrono::nanoseconds(0);
    }
    std::string name() const override { return "udp " + host_ + ':' + std::to_string(port_); }

private:
    void open_descriptor() override {
        asio::ip::udp::resolver resolver(context_);
        const auto found = resolver.resolve(host_, std::to_string(port_), asio::ip::resolver_base::numeric_service);
        socket_ = asio::ip::udp::socket(context_, found.begin()->endpoint().protocol());
        socket_.connect(found.begin()->endpoint());
        boost::system::error_code ignored;  // the system's smallest is a few datagrams
        socket_.set_option(asio::socket_base::send_buffer_size(4096), ignored);
        socket_.native_non_blocking(true);
    }
    void close_descriptor() override {
        boost::system::error_code ignored;
        socket_.close(ignored);
    }
    int descriptor() const override { return const_cast<asio::ip::udp::socket&>(socket_).native_handle(); }
    // Nobody listens yet, a route is missing: that may change while the socket stays.
    bool outlives(int /*error*/) const override { return true; }
    std::string advice() const override {
        return "start what listens there, or name it with --udp; messages are sent all the same";
    }

    std::string host_;
    std::uint16_t port_;
    asio::io_context context_;
    asio::ip::udp::socket socket_{context_};
};

class SerialLink : public Link {
public:
    SerialLink(std::string device, unsigned baud) : device_(std::move(device)), baud_(baud) {}

    std::chrono::nanoseconds time_for(std::size_t bytes) const override {
        int waiting = 0;
        if (::ioctl(descriptor(), TIOCOUTQ, &waiting) != 0) {
            waiting = 0;
        }
        return time_of(static_cast<std::size_t>(waiting) + bytes);
    }
    std::string name() const override { return "serial " + device_ + ':' + std::to_string(baud_); }

private:
    void open_descriptor() override {
        port_ = asio::serial_port(context_, device_);
        port_.set_option(asio::serial_port::baud_rate(baud_));
        port_.set_option(asio::serial_port::character_size(8));
        port_.set_option(asio::serial_port::parity(asio::serial_port::parity::none));
        port_.set_option(asio::serial_port::stop_bits(asio::serial_port::stop_bits::one));
        port_.set_option(asio::serial_port::flow_control(asio::serial_port::flow_control::none));
        ::tcflush(descriptor(), TCIOFLUSH);
    }
    void close_descriptor() override {
        boost::system::error_code ignored;
        forget_waiting();  // closing would wait for it
        port_.close(ignored);
    }
    int descriptor() const override { return const_cast<asio::serial_port&>(port_).native_handle(); }
    bool outlives(int /*error*/) const override { return false; }
    void forget_waiting() const override { ::tcflush(descriptor(), TCOFLUSH); }
    std::chrono::nanoseconds time_of(std::size_t bytes) const override {
        constexpr std::int64_t bits_of_a_byte = 10;  // with start and stop bit
        return std::chrono::nanoseconds(static_cast<std::int64_t>(bytes) * bits_of_a_byte * 1'000'000'000 / baud_);
    }
    std::string advice() const override {
        return "plug it in, free it or name another one with --serial; it is tried again and again";
    }

    std::string device_;
    unsigned baud_;
    asio::io_context context_;
    asio::serial_port port_{context_};
};

}  // namespace

std::unique_ptr<Link> udp_link(const std::string& host, std::uint16_t port) {
    return std::make_unique<UdpLink>(host, port);
}

std::unique_ptr<Link> serial_link(const std::string& device, unsigned baud) {
    return std::make_unique<SerialLink>(device, baud);
}

bool Link::open() {
    if (is_open_ || Clock::now() < next_try_) {
        return is_open_;
    }
    try {
        open_descriptor();
        is_open_ = true;
        empty_at_ = Clock::now();
        problem_.clear();
        pause_ = {};
    } catch (const boost::system::system_error& error) {
        fail(error.code().message());
    }
    return is_open_;
}

void Link::fail(const std::string& reason) {
    problem_ = name() + ": " + reason + "; " + advice();
    if (is_open_ || descriptor() >= 0) {
        close_descriptor();
    }
    is_open_ = false;
    pause_ = pause_.count() == 0 ? first_pause : std::min(2 * pause_, longest_pause);
    next_try_ = Clock::now() + pause_;
}

bool Link::send(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
    return open() && write_all(bytes, deadline);
}

bool Link::forget_old() {
    if (!is_open_ || Clock::now() < empty_at_ + grace) {
        return false;
    }
    // A message that is cut has a wrong checksum: receivers find the next one. On a line that is read nothing waits
    // now.
    forget_waiting();
    return true;
}

bool Link::write_all(std::span<const std::uint8_t> bytes, Clock::time_point deadline) {
    bool refused = false;
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor(), bytes.data(), bytes.size());
        const int error = written < 0 ? errno : EAGAIN;
        if (written > 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(written));
            empty_at_ = std::max(empty_at_, Clock::now()) + time_of(static_cast<std::size_t>(written));
        } else if (error == ECONNREFUSED && !refused) {
            refused = true;  // this is about an earlier datagram, and this one was not sent
        } else if (error == EAGAIN) {
            if (!wait_for_room(descriptor(), deadline)) {
                forget_waiting();
                empty_at_ = Clock::now();
                problem_ = name() + ": there was no room for a message in time; use a faster link or a lower --rate";
                return false;
            }
        } else if (error != EINTR) {
            problem_ = name() + ": " + std::generic_category().message(error) + "; " + advice();
            if (!outlives(error)) {
                fail(std::generic_category().message(error));
            }
            return false;
        }
    }
    problem_.clear();
    if (refused) {
        problem_ = name() + ": nobody listens there; " + advice();
    }
    return true;
}

void Link::drain(const std::function<void(std::span<const std::uint8_t> bytes)>& take) {
    std::array<std::uint8_t, 4096> bytes;
    // Not for ever: a sender may be as fast as this.
    for (int reads = 0; is_open_ && reads < 64; ++reads) {
        const ssize_t got = ::read(descriptor(), bytes.data(), bytes.size());
        const int error = errno;
        if (got > 0 && take) {
            take(std::span(bytes).first(static_cast<std::size_t>(got)));
        }
        if (got > 0 || (got == 0 && outlives(0)) || (got < 0 && error == EINTR)) {
            continue;
        }
        if (got < 0 && (error == EAGAIN || outlives(error))) {
            return;
        }
        fail(got == 0 ? "the device has gone" : std::generic_category().message(error));
    }
}

}  // namespace disparityd::mavlink
