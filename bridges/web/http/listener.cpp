// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/listener.h"

#include <stdexcept>
#include <utility>

#include <boost/asio/write.hpp>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace disparityd::web {
namespace {

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

}  // namespace

PortListener::PortListener(const ServerSettings& settings, const Site& site)
    : site_(site),
      acceptor_(listening(site.place.network, settings)),
      pause_(site.place.network),
      tls_(tls_context(settings.tls)) {}

void PortListener::stop() {
    error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
}

template <typename Stream>
void PortListener::serve(Stream&& stream, const std::string& sender) {
    const auto session =
        std::make_shared<HttpSession<std::decay_t<Stream>>>(std::forward<Stream>(stream), site_, sender);
    if (site_.connections.admit(session, sender)) {
        session->start();
    } else {
        ++site_.place.hub.counters.refused;
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
        if (tls_) {
            serve(TlsStream(PlainStream(std::move(socket)), *tls_), sender);
        } else {
            serve(PlainStream(std::move(socket)), sender);
        }
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

}  // namespace disparityd::web
