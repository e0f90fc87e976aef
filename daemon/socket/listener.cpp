// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/listener.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/failure_text.h"
#include "daemon/config/socket_address.h"
#include "daemon/log.h"

namespace disparityd::daemon {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using local = asio::local::stream_protocol;
using boost::system::error_code;

[[noreturn]] void refuse(const std::string& what, const std::string& key, const error_code& error) {
    const std::string reason = base::error_text(error.value());
    if (error.value() == EMFILE || error.value() == ENFILE || error.value() == ENOMEM) {  // the address is not to blame
        throw std::runtime_error(fmt::format("cannot serve at {}: {}", what, reason));
    }
    const bool in_use = error == asio::error::address_in_use;
    throw std::runtime_error(fmt::format("cannot serve at {}: {}; {}[socket] {}", what, reason,
                                         in_use ? "stop the program that uses it, or set another " : "set another ",
                                         key));
}

/// The common part of both listeners: accepts clients, and tries again when descriptors run out.
template <typename Protocol>
class AcceptingListener : public Listener, public std::enable_shared_from_this<AcceptingListener<Protocol>> {
public:
    explicit AcceptingListener(asio::io_context& io) : acceptor_(io), retry_(io) {}

    void serve(Accepted accepted) override {
        accepted_ = std::move(accepted);
        asio::post(acceptor_.get_executor(), [self = this->shared_from_this()] { self->accept(); });
    }

    void close() override {
        error_code ignored;
        acceptor_.close(ignored);
        retry_.cancel();
    }

protected:
    virtual const char* key() const = 0;
    virtual ClientPeer peer_of(typename Protocol::socket& socket) = 0;

    /// Binds and listens at once: another daemon would take an address that is only bound for a leftover one.
    void bind(const typename Protocol::endpoint& endpoint, error_code& error) {
        acceptor_.bind(endpoint, error);
        if (!error) {
            acceptor_.listen(asio::socket_base::max_listen_connections, error);
        }
    }

    typename Protocol::acceptor acceptor_;

private:
    void accept() {
        acceptor_.async_accept([self = this->shared_from_this()](error_code error, typename Protocol::socket socket) {
            if (error == asio::error::operation_aborted || !self->acceptor_.is_open()) {
                return;
            }
            if (error) {
                self->accept_later(error);
                return;
            }
            try {
                ClientPeer peer = self->peer_of(socket);
                self->accepted_(std::move(socket), std::move(peer));
            } catch (const std::exception& failure) {
                self->limiter_.write(LogLevel::warning,
                                     fmt::format("a client that has connected is not served: {}", failure.what()));
            }
            self->accept();
        });
    }

    /// Out of descriptors: the connection waits in the system's queue until there are some.
    void accept_later(const error_code& error) {
        limiter_.write(LogLevel::warning, fmt::format("{}: cannot accept a client: {}; trying again", address(),
                                                      base::error_text(error.value())));
        retry_.expires_after(std::chrono::milliseconds(100));
        retry_.async_wait([self = this->shared_from_this()](error_code stopped) {
            if (!stopped && self->acceptor_.is_open()) {
                self->accept();
            }
        });
    }

    asio::steady_timer retry_;
    Accepted accepted_;
    LogLimiter limiter_{5, std::chrono::seconds(10)};
};

class TcpListener final : public AcceptingListener<tcp> {
public:
    TcpListener(asio::io_context& io, const std::string& text) : AcceptingListener(io) {
        const TcpAddress parsed = parse_tcp_address(text);
        const tcp::endpoint endpoint(asio::ip::make_address(parsed.host), parsed.port);
        error_code error;
        acceptor_.open(endpoint.protocol(), error);
        if (!error) {
            acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
        }
        if (!error) {
            bind(endpoint, error);
        }
        if (error) {
            refuse("tcp:" + text, key(), error);
        }
        const tcp::endpoint bound = acceptor_.local_endpoint();
        const std::string host = bound.address().to_string();
        address_ = fmt::format("tcp:{}:{}", bound.address().is_v6() ? '[' + host + ']' : host, bound.port());
    }

    std::string address() const override { return address_; }

private:
    const char* key() const override { return "tcp"; }

    ClientPeer peer_of(tcp::socket& socket) override {
        error_code error;
        socket.set_option(tcp::no_delay(true), error);
        const tcp::endpoint peer = socket.remote_endpoint(error);
        return {
            .address = error ? std::string("tcp") : fmt::format("tcp:{}:{}", peer.address().to_string(), peer.port()),
            .user = {}};
    }

    std::string address_;
};

class UnixListener final : public AcceptingListener<local> {
public:
    UnixListener(asio::io_context& io, std::string path) : AcceptingListener(io), path_(std::move(path)) {
        remove_left_over(io);
        error_code error;
        acceptor_.open(local(), error);
        if (!error) {
            // The file gets the mode of the socket: no other user can connect before chmod() sets the full mode.
            fchmod(acceptor_.native_handle(), file_mode);
            bind(local::endpoint(path_), error);
        }
        if (error) {
            refuse(address(), key(), error);
        }
        struct stat mine {};
        if (chmod(path_.c_str(), file_mode) != 0 || lstat(path_.c_str(), &mine) != 0) {
            refuse(address(), key(), error_code(errno, boost::system::system_category()));
        }
        device_ = mine.st_dev;
        inode_ = mine.st_ino;
    }

    ~UnixListener() override { remove_file(); }

    void close() override {
        AcceptingListener::close();
        remove_file();
    }

    std::string address() const override { return "unix:" + path_; }

    bool in_place() const override {
        struct stat found {};
        return lstat(path_.c_str(), &found) == 0 && found.st_ino == inode_ && found.st_dev == device_;
    }

private:
    static constexpr mode_t file_mode = 0660;

    const char* key() const override { return "unix"; }

    ClientPeer peer_of(local::socket& socket) override {
        ClientPeer peer{.address = "unix", .local = true, .user = {}};
        ucred credentials{};
        socklen_t size = sizeof(credentials);
        if (getsockopt(socket.native_handle(), SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0) {
            peer.user = credentials.uid;
            peer.groups = groups_of_peer(socket.native_handle());
        }
        return peer;
    }

    void remove_left_over(asio::io_context& io) {
        struct stat found {};
        if (lstat(path_.c_str(), &found) != 0) {
            return;
        }
        if (!S_ISSOCK(found.st_mode)) {
            throw std::runtime_error(fmt::format(
                "cannot serve at unix:{}: something that is no socket has this name; remove it, or set another "
                "[socket] unix",
                path_));
        }
        error_code error;
        local::socket probe(io);
        probe.open(local(), error);
        if (!error) {
            // A process that listens there and does not accept must not block this thread.
            probe.non_blocking(true, error);
        }
        if (!error) {
            probe.connect(local::endpoint(path_), error);
        }
        // A full backlog is EAGAIN, which Asio reports as no_buffer_space.
        if (!error || error == asio::error::try_again || error == asio::error::no_buffer_space) {
            refuse(address(), key(), asio::error::address_in_use);
        }
        if (error != asio::error::connection_refused && error != boost::system::errc::no_such_file_or_directory) {
            refuse(address(), key(), error);  // another daemon may run there
        }
        if (unlink(path_.c_str()) != 0) {
            refuse(address(), key(), error_code(errno, boost::system::system_category()));
        }
        log_warning(fmt::format("{}: left over from a daemon that is gone; replaced", address()));
    }

    /// Removes the file if it is still this one: another daemon may have replaced it.
    void remove_file() {
        if (!removed_.exchange(true) && in_place()) {
            unlink(path_.c_str());
        }
    }

    std::string path_;
    dev_t device_ = 0;
    ino_t inode_ = 0;
    std::atomic<bool> removed_{false};
};

}  // namespace

std::shared_ptr<Listener> make_tcp_listener(asio::io_context& io, const std::string& address) {
    return std::make_shared<TcpListener>(io, address);
}

std::shared_ptr<Listener> make_unix_listener(asio::io_context& io, const std::string& path) {
    return std::make_shared<UnixListener>(io, path);
}

}  // namespace disparityd::daemon
