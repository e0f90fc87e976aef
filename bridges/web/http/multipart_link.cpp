// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/multipart_link.h"

#include <algorithm>

#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>

#include "bridges/web/http/unacknowledged.h"

namespace disparityd::web {

void MultipartLink::start(const std::string& head) {
    // First the read, without a timer: a timer that runs when it begins would end the stream later.
    boost::beast::get_lowest_layer(stream_).expires_never();
    watch();
    handler_->on_open(*this);
    send_binary({std::make_shared<const std::string>(head)});
}

/// Waits for the end: the peer has nothing more to say.
void MultipartLink::watch() {
    stream_.async_read_some(boost::asio::buffer(&unread_, 1), [self = shared_from_this()](Error error, std::size_t) {
        if (error) {
            self->end();
        } else {
            self->watch();
        }
    });
}

/// Only to be called when the link is not busy.
void MultipartLink::send_binary(std::vector<Bytes> parts) {
    written_ = std::move(parts);
    sending_ = true;
    deadline_ = Clock::now() + patience;
    std::vector<boost::asio::const_buffer> buffers;
    std::size_t bytes = 0;
    for (const Bytes& part : written_) {
        buffers.emplace_back(part->data(), part->size());
        bytes += part->size();
    }
    load_ = outgoing_.hold(bytes, Clock::now(), [weak = weak_from_this()] {
        if (const auto self = weak.lock()) {
            self->drop();
        }
    });
    boost::beast::get_lowest_layer(stream_).expires_at(deadline_);
    boost::asio::async_write(stream_, buffers,
                             [self = shared_from_this()](Error error, std::size_t) { self->on_written(error); });
}

void MultipartLink::on_written(Error error) {
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
void MultipartLink::wait_until_acknowledged(std::chrono::milliseconds pause) {
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
    timer_.async_wait([self = shared_from_this(), pause](Error error) {
        if (!error) {
            self->wait_until_acknowledged(std::min(2 * pause, longest_look));
        }
    });
}

void MultipartLink::end() {
    timer_.cancel();
    if (const auto handler = std::exchange(handler_, nullptr)) {
        handler->on_closed();
    }
    drop();
}

}  // namespace disparityd::web
