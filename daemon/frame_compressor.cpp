// SPDX-License-Identifier: Apache-2.0
#include "daemon/frame_compressor.h"

#include <exception>
#include <utility>

#include <boost/asio/post.hpp>

namespace disparityd {

namespace asio = boost::asio;

void FrameCompressor::ask(const std::shared_ptr<Client>& client) {
    waiting_.push_back(client);
    // Not from here: the client is in the middle of something.
    asio::post(server_, [this] { next(); });
}

void FrameCompressor::next() {
    while (!busy_ && !waiting_.empty()) {
        const auto client = waiting_.front().lock();
        waiting_.pop_front();
        const Wish wish = client ? client->next_wish() : Wish{};
        if (!wish.frame) {
            continue;
        }
        busy_ = true;
        asio::post(worker_, [this, &server = server_, encoder = encoder_, client, wish] {
            Result result;
            try {
                result.planes = std::make_shared<const EncodedPlanes>(encoder->encode(*wish.frame, wish.selection));
            } catch (const std::exception& error) {
                result.failure = error.what();
            }
            asio::post(server, [this, client, wish, result] { finished(client, wish, result); });
        });
    }
}

void FrameCompressor::finished(const std::shared_ptr<Client>& client, const Wish& wish, const Result& result) {
    busy_ = false;
    if (!result.planes) {
        client->not_compressed(result.failure);
        next();
        return;
    }
    client->compressed(wish, result.planes);
    // Others who want the same need not wait for their turn.
    for (auto& place : std::exchange(waiting_, {})) {
        const auto other = place.lock();
        if (other && other->would_wish(wish)) {
            other->compressed(other->next_wish(), result.planes);
        } else if (other) {
            waiting_.push_back(std::move(place));
        }
    }
    next();
}

}  // namespace disparityd
