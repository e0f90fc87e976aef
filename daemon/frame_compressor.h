// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/io_context.hpp>

#include "daemon/frame_encoder.h"
#include "daemon/frame_pool.h"

namespace disparityd {

/// Compresses frames for clients in a thread of its own, one frame after the other in the order in which clients have
/// asked: whoever wants frames as they are never waits for it, and one who wants many gets no more than the others. All
/// calls, both ways, in the server's thread.
class FrameCompressor {
public:
    /// What of which frame.
    struct Wish {
        FrameHandle frame;
        Selection selection;
    };

    class Client {
    public:
        virtual ~Client() = default;
        /// What it wants when its turn has come: only now, so that those who wait hold no frames. No frame: nothing.
        virtual Wish next_wish() = 0;
        /// Whether that would be the same.
        virtual bool would_wish(const Wish& wish) const = 0;
        /// The answer to next_wish(), later.
        virtual void compressed(const Wish& wish, std::shared_ptr<const EncodedPlanes> planes) = 0;
        virtual void not_compressed(const std::string& why) = 0;
    };

    /// `server`: what runs the server's thread, and does so no more when this object ends. `worker`: what compresses,
    /// one frame at a time. Both outlive this object.
    FrameCompressor(boost::asio::io_context& server, boost::asio::any_io_executor worker)
        : server_(server), worker_(std::move(worker)) {}
    FrameCompressor(const FrameCompressor&) = delete;
    FrameCompressor& operator=(const FrameCompressor&) = delete;

    /// The client waits for its turn from now on, once.
    void ask(const std::shared_ptr<Client>& client);

private:
    struct Result {
        std::shared_ptr<const EncodedPlanes> planes;
        std::string failure;
    };

    void next();
    void finished(const std::shared_ptr<Client>& client, const Wish& wish, const Result& result);

    boost::asio::io_context& server_;
    boost::asio::any_io_executor worker_;
    std::deque<std::weak_ptr<Client>> waiting_;
    bool busy_ = false;
    /// The worker's; shared, since it may still be at a frame when this object ends.
    std::shared_ptr<FrameEncoder> encoder_ = std::make_shared<FrameEncoder>();
};

}  // namespace disparityd
