// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>

#include "bridges/web/http/connections.h"
#include "bridges/web/live/message_link.h"

namespace disparityd::web {

/// A response without end: each binary message is written as it is, after the head of the response. The operations
/// under way keep it alive.
template <typename Stream>
class MultipartLink : public MessageLink,
                      public Connection,
                      public std::enable_shared_from_this<MultipartLink<Stream>> {
public:
    MultipartLink(Stream&& stream, std::shared_ptr<MessageHandler> handler)
        : stream_(std::move(stream)), handler_(std::move(handler)) {}

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
    bool busy() const override { return !written_.empty(); }
    void drop() override { boost::beast::get_lowest_layer(stream_).close(); }
    bool idle() const override { return false; }

private:
    using Error = boost::system::error_code;

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

    void end() {
        if (const auto handler = std::exchange(handler_, nullptr)) {
            handler->on_closed();
        }
        drop();
    }

    Stream stream_;
    std::shared_ptr<MessageHandler> handler_;  ///< nullptr after the end
    std::vector<Bytes> written_;               ///< what is on its way out
    char unread_ = 0;
};

/// Only to be called when the link is not busy.
template <typename Stream>
void MultipartLink<Stream>::send_binary(std::vector<Bytes> parts) {
    written_ = std::move(parts);
    std::vector<boost::asio::const_buffer> buffers;
    for (const Bytes& part : written_) {
        buffers.emplace_back(part->data(), part->size());
    }
    // A peer that reads nothing ends after this.
    boost::beast::get_lowest_layer(stream_).expires_after(std::chrono::seconds(20));
    boost::asio::async_write(stream_, buffers, [self = this->shared_from_this()](Error error, std::size_t) {
        self->written_.clear();
        if (error) {
            self->end();
            return;
        }
        boost::beast::get_lowest_layer(self->stream_).expires_never();
        if (const auto handler = self->handler_) {
            handler->on_sent();
        }
    });
}

}  // namespace disparityd::web
