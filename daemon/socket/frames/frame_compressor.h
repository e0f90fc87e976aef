// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/io_context.hpp>

#include "daemon/socket/frames/frame_encoder.h"
#include "daemon/socket/frames/frame_pool.h"

namespace disparityd::daemon {

/// Counts how much of the compressor one client has used. One thread.
class CompressorAccount {
public:
    using Clock = std::chrono::steady_clock;

    /// Adds `bytes` of input and `time` of the compressor's thread, which ended at `now`.
    void charge(std::uint64_t bytes, std::chrono::nanoseconds time, Clock::time_point now) {
        bytes_ += bytes;
        time_ += time;
        roll(now);
        current_ += time;
    }

    std::uint64_t bytes() const { return bytes_; }
    std::chrono::nanoseconds time() const { return time_; }

    /// Returns the client's share of the compressor's time in the last one to two seconds, 0 .. 1.
    double share(Clock::time_point now) {
        roll(now);
        const std::chrono::duration<double> had = before_ + current_;
        const double share = had / (interval + (now - since_));
        return share < 1 ? share : 1;
    }

private:
    static constexpr Clock::duration interval = std::chrono::seconds(1);

    void roll(Clock::time_point now) {
        if (now - since_ < interval) {
            return;
        }
        before_ = now - since_ < 2 * interval ? current_ : std::chrono::nanoseconds(0);
        current_ = {};
        since_ = now - since_ < 2 * interval ? since_ + interval : now;
    }

    std::uint64_t bytes_ = 0;
    std::chrono::nanoseconds time_{0};
    Clock::time_point since_ = Clock::now();  ///< start of the second that current_ counts
    std::chrono::nanoseconds current_{0};
    std::chrono::nanoseconds before_{0};  ///< in the previous second
};

/// Compresses frames in a thread of its own, one after the other. Clients that want raw frames never wait for it.
///
/// Turns are fair by bytes: weighted fair queueing with equal weights. Each client has a clock (virtual time), which
/// advances by the cost of what is compressed for it. The waiting client whose clock would be lowest after its turn is
/// next. Clients that want more than the compressor can do get the same number of bytes each, as whole frames or small
/// regions; a client that wants less than this share gets all of it. Turns cannot be saved up: a client that comes back
/// starts at the clock of the frame in work, and a new client is queued behind those that wait. Equal requests are
/// compressed once, and the cost is divided between their clients.
///
/// All calls, of both classes, are made in the server's thread.
class FrameCompressor {
public:
    /// A frame, and which part of it.
    struct Request {
        FrameHandle frame;
        Selection selection;

        /// Returns its cost: the bytes of its planes before compression, plus a constant for each plane.
        std::uint64_t cost() const;
    };

    class Client {
    public:
        virtual ~Client() = default;
        /// Returns the request when the client's turn comes; before that, a waiting client holds no frame. A null
        /// frame: there is nothing to compress.
        virtual Request next_request() noexcept = 0;
        /// Returns whether next_request() would return `request`.
        virtual bool same_request(const Request& request) const noexcept = 0;
        /// Takes the result of next_request().
        virtual void compressed(const Request& request, std::shared_ptr<const EncodedPlanes> planes) noexcept = 0;
        virtual void not_compressed(const std::string& why) noexcept = 0;

        CompressorAccount& account() { return account_; }

    private:
        friend class FrameCompressor;
        CompressorAccount account_;
        std::uint64_t clock_ = 0;
        std::uint64_t price_ = 0;  ///< cost of its last frame, the estimate for the next
    };

    /// `server` runs the server's thread, and has stopped when this object ends. `worker` runs the compression, one
    /// frame at a time. Both outlive this object.
    FrameCompressor(boost::asio::io_context& server, boost::asio::any_io_executor worker)
        : server_(server), worker_(std::move(worker)) {}
    FrameCompressor(const FrameCompressor&) = delete;
    FrameCompressor& operator=(const FrameCompressor&) = delete;

    /// Queues the client for one turn.
    void ask(const std::shared_ptr<Client>& client);

private:
    struct Waiting {
        std::weak_ptr<Client> client;
        std::uint64_t start = 0;  ///< its clock, at least that of the frame in work when it asked
        std::uint64_t end = 0;    ///< its clock after the turn, if it wants as much as the last time
    };

    /// One frame on its way between the two threads. The worker owns it until finished() is posted.
    struct Work {
        FrameEncoder encoder;
        std::shared_ptr<Client> client;
        Request request;
        std::shared_ptr<const EncodedPlanes> planes;
        std::string failure;
        std::chrono::nanoseconds time{0};

        void run();
    };

    void next();
    std::shared_ptr<Client> take_first() noexcept;
    void begin();
    void finished();
    void hand_to_others(const std::shared_ptr<const EncodedPlanes>& planes, int sharers, std::size_t waiting);
    void charge(Client& client, int sharers) const noexcept;

    boost::asio::io_context& server_;
    boost::asio::any_io_executor worker_;
    std::vector<Waiting> waiting_;  ///< in the order in which they asked
    std::uint64_t now_ = 0;         ///< clock at which the frame in work began
    bool busy_ = false;
    /// Shared: the worker may still compress a frame when this object ends.
    std::shared_ptr<Work> work_ = std::make_shared<Work>();
};

}  // namespace disparityd::daemon
