// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/server.h"

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include "bridges/web/http/all_daemons.h"
#include "bridges/web/http/http_session.h"
#include "bridges/web/http/server_settings.h"

namespace disparityd::web {
namespace {

/// Takes connections on one port. The network's thread owns it.
class PortListener {
public:
    /// Throws std::runtime_error with one line.
    PortListener(const ServerSettings& settings, const Site& site);

    void start() { accept(); }
    void stop();
    std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

private:
    void accept();
    void accept_after(std::chrono::milliseconds pause);
    void serve(PeerStream stream, const std::string& sender);

    Site site_;
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::steady_timer pause_;
    std::unique_ptr<boost::asio::ssl::context> tls_;  ///< nullptr: not encrypted
};

namespace asio = boost::asio;
using boost::system::error_code;

std::unique_ptr<asio::ssl::context> tls_context(const proto::TlsFiles& files) {
    if (!files.on()) {
        return nullptr;
    }
    const proto::TlsContext made = proto::make_server_tls(files, "disparity-web");
    SSL_CTX_up_ref(made.get());  // Asio's object frees it, too
    return std::make_unique<asio::ssl::context>(made.get());
}

asio::ip::tcp::acceptor listening(asio::io_context& network, const ServerSettings& settings) {
    const std::string where = settings.host + ':' + std::to_string(settings.port);
    error_code error;
    const auto address = asio::ip::make_address(settings.host, error);
    if (error) {
        throw std::runtime_error("cannot listen at " + where +
                                 ": the host must be an address of this machine, such as "
                                 "127.0.0.1 or 0.0.0.0");
    }
    asio::ip::tcp::acceptor acceptor(network);
    const asio::ip::tcp::endpoint endpoint(address, settings.port);
    acceptor.open(endpoint.protocol(), error);
    if (!error) {
        acceptor.set_option(asio::ip::tcp::acceptor::reuse_address(true), error);
    }
    if (!error) {
        acceptor.bind(endpoint, error);
    }
    if (!error) {
        acceptor.listen(asio::socket_base::max_listen_connections, error);
    }
    if (error) {
        throw std::runtime_error("cannot listen at " + where + ": " + error.message() +
                                 "; choose another port with --listen");
    }
    return acceptor;
}

/// A peer whose machine is gone says nothing: the kernel asks it after half a minute.
void notice_vanished_peers(asio::ip::tcp::socket& socket) {
    error_code ignored;
    socket.set_option(asio::socket_base::keep_alive(true), ignored);
    const int seconds = 30;
    setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPIDLE, &seconds, sizeof seconds);
}

/// Each new connection then ends an idle one. With 128 places one lasts a quarter of a second, time enough for a
/// request, and who begins anew all the time takes little of the server's time from the pages.
constexpr std::chrono::milliseconds pause_when_full{2};

PortListener::PortListener(const ServerSettings& settings, const Site& site)
    : site_(site),
      acceptor_(listening(site.parts.network, settings)),
      pause_(site.parts.network),
      tls_(tls_context(settings.tls)) {}

void PortListener::stop() {
    error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
}

void PortListener::serve(PeerStream stream, const std::string& sender) {
    const auto session = std::make_shared<HttpSession>(std::move(stream), site_, sender);
    if (site_.connections.admit(session, sender)) {
        session->start();
    } else {
        ++site_.parts.counters.refused;
    }
}

void PortListener::accept() {
    acceptor_.async_accept([this](error_code error, asio::ip::tcp::socket socket) {
        if (error == asio::error::operation_aborted) {
            return;
        }
        if (error) {
            // Without descriptors the next try fails at once: others must end theirs first.
            accept_after(std::chrono::milliseconds(200));
            return;
        }
        socket.set_option(asio::ip::tcp::no_delay(true), error);
        notice_vanished_peers(socket);
        const auto peer = socket.remote_endpoint(error);
        const std::string sender = error ? std::string() : sender_of(peer.address());
        serve(tls_ ? PeerStream(std::move(socket), *tls_) : PeerStream(std::move(socket)), sender);
        if (site_.connections.full()) {
            accept_after(pause_when_full);
        } else {
            accept();
        }
    });
}

void PortListener::accept_after(std::chrono::milliseconds pause) {
    pause_.expires_after(pause);
    pause_.async_wait([this](error_code ended) {
        if (!ended && acceptor_.is_open()) {  // its end may be on the way while stop() cancels it
            accept();
        }
    });
}

std::unique_ptr<ServedDaemons> daemons_of(const ServerSettings& settings, const ServerParts& parts) {
    if (settings.all) {
        return std::make_unique<AllDaemons>(parts);
    }
    return std::make_unique<OneDaemon>(parts, settings.daemon);
}

}  // namespace

namespace asio = boost::asio;

/// The parts, in the order in which they end: the last one first.
class Server::Impl {
public:
    explicit Impl(const ServerSettings& settings)
        : url_host_(settings.host.find(':') == std::string::npos ? settings.host : '[' + settings.host + ']'),
          scheme_(settings.tls.on() ? "https" : "http"),
          access_(settings.access, settings.tls.on()),
          signals_(network_, SIGTERM, SIGINT),
          connections_(static_cast<std::size_t>(settings.max_connections), access_.knows_controllers()),
          routes_(network_, access_),
          daemons_(daemons_of(settings, parts_)),
          listener_(settings, {parts_, access_, routes_, *daemons_, connections_, guesses_}) {}

    std::string url() const { return scheme_ + "://" + url_host_ + ':' + std::to_string(listener_.port()) + '/'; }

    void run() {
        signals_.async_wait([this](const boost::system::error_code& error, int) {
            if (!error) {
                listener_.stop();
                connections_.drop_all();
                network_.stop();
            }
        });
        listener_.start();
        network_.run();
        // Each may wait for a daemon that hangs: all at the same time.
        daemons_->stop();
        // A second signal ends the program at once.
        signals_.clear();
        std::signal(SIGTERM, SIG_DFL);
        std::signal(SIGINT, SIG_DFL);
    }

private:
    std::string url_host_;
    std::string scheme_;
    Access access_;
    Outgoing outgoing_;
    WebCounters counters_;
    asio::io_context network_{1};
    asio::signal_set signals_;
    EncodingTurns encoding_;
    Connections connections_;
    TokenGuesses guesses_;
    ServerParts parts_{network_, encoding_, outgoing_, counters_};
    Routes routes_;
    std::unique_ptr<ServedDaemons> daemons_;
    PortListener listener_;
};

Server::Server(const ServerSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
Server::~Server() = default;

std::string Server::url() const {
    return impl_->url();
}

void Server::run() {
    impl_->run();
}

}  // namespace disparityd::web
