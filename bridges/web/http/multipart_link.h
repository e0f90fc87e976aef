// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/http/unacknowledged.h"
#include "bridges/web/live/message_link.h"
#include "bridges/web/live/outgoing.h"

namespace disparityd::web {

/// A response without end: each binary message is written as it is, after the head of the response. A message is out
/// when the peer's system has acknowledged all of it: what waits in this one would be old when it arrives. The
/// operations under way keep it alive.
template <typename Stream>
class MultipartLink : public MessageLink,
                      public Connection,
                      public std::enable_shared_from_this<MultipartLink<Stream>> {
public:
    MultipartLink(Stream&& stream, std::shared_ptr<MessageHandler> handler, Outgoing& outgoing)
        : stream_(std::move(stream)),
          handler_(std::move(handler)),
          outgoing_(outgoing),
          timer_(stream_.get_executor()) {}

    /// Writes the head of the response, and begins.
    void start(const std::string& head) {
        // First the read, without a timer: a timer that runs when it begins would end the stream later.
        boost::beast::get_lowest_layer(stream_).expires_never();
        watch();
        handler_->on_open(*this);
        send_binary({std::make_shared<const std::string>(head)});
    }

    void send_text(std::string /*text*/) override {}  // it has no place between the parts
    void send_binary(std::vector<Bytes> parts) override;
    bool busy() const override { return sending_ || !outgoing_.has_room(Clock::now()); }
    void ask_for_answer(std::string /*mark*/) override {}  // HTTP has none
    void drop() override { boost::beast::get_lowest_layer(stream_).close(); }
    bool idle() const override { return false; }

private:
    using Clock = std::chrono::steady_clock;
    using Error = boost::system::error_code;
    /// A peer that does not take a message within this time is ended.
    static constexpr std::chrono::seconds patience{20};
    static constexpr std::chrono::milliseconds shortest_look{1};
    static constexpr std::chrono::milliseconds longest_look{20};

    /// Waits for the end: the peer has nothing more to say.
    void watch() {
        stream_.async_read_some(boost::asio::buffer(&unread_, 1),
                                [self = this->shared_from_this()](Error error, std::size_t) {
                                    if (error) {
                                        self->end();
                                    } else {
                                        self->watch();
                                    }
                                });
    }

    void on_written(Error error);
    void wait_until_acknowledged(std::chrono::milliseconds pause);

    void end() {
        timer_.cancel();
        if (const auto handler = std::exchange(handler_, nullptr)) {
            handler->on_closed();
        }
        drop();
    }

    Stream stream_;
    std::shared_ptr<MessageHandler> handler_;  ///< nullptr after the end
    Outgoing& outgoing_;
    boost::asio::steady_timer timer_;
    std::vector<Bytes> written_;  ///< what is on its way out of this program
    std::unique_ptr<Outgoing::Load> load_;
    bool sending_ = false;
    Clock::time_point deadline_;
    char unread_ = 0;
};

/// Only to be called when the link is not busy.
template <typename Stream>
void MultipartLink<Stream>::send_binary(std::vector<Bytes> parts) {
    written_ = std::move(parts);
    sending_ = true;
    deadline_ = Clock::now() + patience;
    std::vector<boost::asio::const_buffer> buffers;
    std::size_t bytes = 0;
    for (const Bytes& part : written_) {
        buffers.emplace_back(part->data(), part->size());
        bytes += part->size();
    }
    load_ = outgoing_.hold(bytes, Clock::now(), [weak = this->weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->drop();
        }
    });
    boost::beast::get_lowest_layer(stream_).expires_at(deadline_);
    boost::asio::async_write(stream_, buffers,
                             [self = this->shared_from_this()](Error error, std::size_t) { self->on_written(error); });
}

template <typename Stream>
void MultipartLink<Stream>::on_written(Error error) {
    written_.clear();
    load_.reset();
    if (error) {
        end();
        return;
    }
    boost::beast::get_lowest_layer(stream_).expires_never();
    wait_until_acknowledged(shortest_look);
}

/// The system tells nobody when a peer has acknowledged: it is asked again and again, less and less often.
template <typename Stream>
void MultipartLink<Stream>::wait_until_acknowledged(std::chrono::milliseconds pause) {
    auto& socket = boost::beast::get_lowest_layer(stream_).socket();
    if (!handler_ || !socket.is_open()) {
        return;  // the operation that reads tells the end
    }
    if (unacknowledged_bytes(socket.native_handle()) == 0) {
        sending_ = false;
        const auto handler = handler_;  // lives through the call, whatever it does to the link
        handler->on_sent();
        return;
    }
    if (Clock::now() >= deadline_) {
        end();
        return;
    }
    timer_.expires_after(pause);
    timer_.async_wait([self = this->shared_from_this(), pause](Error error) {
        if (!error) {
            self->wait_until_acknowledged(std::min(2 * pause, longest_look));
        }
    });
}

}  // namespace disparityd::web
