// SPDX-License-Identifier: Apache-2.0
#include "daemon/listener.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/log.h"
#include "daemon/socket_address.h"

namespace disparityd {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using local = asio::local::stream_protocol;
using boost::system::error_code;

[[noreturn]] void refuse(const std::string& what, const std::string& key, const error_code& error) {
    const bool in_use = error == asio::error::address_in_use;
    throw std::runtime_error(fmt::format("cannot serve at {}: {}; {}[socket] {}", what, error.message(),
                                         in_use ? "stop the program that uses it, or set another " : "set another ",
                                         key));
}

/// What both kinds of listener have in common: accept again and again, and survive running out of descriptors.
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
    virtual std::string peer_address(typename Protocol::socket& socket) = 0;

    /// Listens at once: nobody may take an address that is bound for one that was left over.
    void bind(const typename Protocol::endpoint& endpoint, error_code& error) {
        acceptor_.bind(endpoint, error);
        if (!error) {
            acceptor_.listen(asio::socket_base::max_listen_connections, error);
        }
    }

    typename Protocol::acceptor acceptor_;

private:
    void accept() {
        if (!acceptor_.is_open()) {
            return;
        }
        acceptor_.async_accept([self = this->shared_from_this()](error_code error, typename Protocol::socket socket) {
            if (error == asio::error::operation_aborted || !self->acceptor_.is_open()) {
                return;
            }
            if (error) {
                // Out of descriptors or memory: the connection waits in the system's queue until there are some.
                self->limiter_.write(LogLevel::warning, fmt::format("{}: cannot accept a client: {}; trying again",
                                                                    self->address(), error.message()));
                self->retry_.expires_after(std::chrono::milliseconds(100));
                self->retry_.async_wait([self](error_code stopped) {
                    if (!stopped) {
                        self->accept();
                    }
                });
                return;
            }
            std::string peer = self->peer_address(socket);
            self->accepted_(std::move(socket), std::move(peer));
            self->accept();
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

    std::string peer_address(tcp::socket& socket) override {
        error_code error;
        socket.set_option(tcp::no_delay(true), error);
        socket.set_option(asio::socket_base::keep_alive(true), error);
        const tcp::endpoint peer = socket.remote_endpoint(error);
        return error ? std::string("tcp") : fmt::format("tcp:{}:{}", peer.address().to_string(), peer.port());
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
            bind(local::endpoint(path_), error);
        }
        if (error) {
            refuse(address(), key(), error);
        }
        struct stat mine {};
        if (chmod(path_.c_str(), 0660) != 0 || stat(path_.c_str(), &mine) != 0) {
            refuse(address(), key(), error_code(errno, boost::system::system_category()));
        }
        inode_ = mine.st_ino;
    }

    ~UnixListener() override { remove_file(); }

    void close() override {
        AcceptingListener::close();
        remove_file();
    }

    std::string address() const override { return "unix:" + path_; }

private:
    const char* key() const override { return "unix"; }
    std::string peer_address(local::socket&) override { return "unix"; }

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
        probe.connect(local::endpoint(path_), error);
        if (!error || error == asio::error::try_again) {
            refuse(address(), key(), asio::error::address_in_use);
        }
        if (error != asio::error::connection_refused && error != boost::system::errc::no_such_file_or_directory) {
            refuse(address(), key(), error);  // it may be a living daemon's
        }
        if (unlink(path_.c_str()) != 0) {
            refuse(address(), key(), error_code(errno, boost::system::system_category()));
        }
        log_warning(fmt::format("{}: left over from a daemon that is gone; replaced", address()));
    }

    /// Only our own: another daemon may have taken the place meanwhile.
    void remove_file() {
        struct stat found {};
        if (!removed_.exchange(true) && stat(path_.c_str(), &found) == 0 && found.st_ino == inode_) {
            unlink(path_.c_str());
        }
    }

    std::string path_;
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

}  // namespace disparityd
