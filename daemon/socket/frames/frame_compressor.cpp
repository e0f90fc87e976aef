// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/frames/frame_compressor.h"

#include <algorithm>
#include <ctime>
#include <exception>
#include <utility>

#include <boost/asio/post.hpp>

#include "base/failure_text.h"

namespace disparityd::daemon {

namespace asio = boost::asio;

namespace {

/// Cost of a plane beside its bytes: a region of one pixel has a cost too.
constexpr std::uint64_t bytes_per_plane = 4096;

/// Returns the processor time of this thread; waiting does not count.
std::chrono::nanoseconds thread_time() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

std::uint64_t FrameCompressor::Request::cost() const {
    const bool whole = selection.region.width == 0;
    const std::uint64_t part = std::uint64_t{selection.region.width} * selection.region.height;
    std::uint64_t cost = 0;
    for (const v1::Product product : selection.products) {
        const ProductShape& shape = frame->shapes[static_cast<std::size_t>(product)];
        cost += (whole || is_record(product) ? shape.bytes() : part * shape.bytes_per_pixel) + bytes_per_plane;
    }
    return cost;
}

void FrameCompressor::Work::run() {
    const auto before = thread_time();
    try {
        planes = std::make_shared<const EncodedPlanes>(encoder.encode(request.frame, request.selection));
    } catch (const std::exception& error) {
        failure = base::failure_text(error);
    }
    time = thread_time() - before;
}

void FrameCompressor::ask(const std::shared_ptr<Client>& client) {
    std::uint64_t start = std::max(now_, client->clock_);
    if (client->price_ == 0) {
        // Its first frame: queued behind the others, or a client that connects anew for each frame would always be
        // next.
        for (const Waiting& other : waiting_) {
            start = std::max(start, other.end);
        }
    }
    waiting_.push_back({client, start, start + client->price_});
    // Posted: the client that calls this cannot be called back here.
    asio::post(server_, [this] { next(); });
}

/// Takes the waiting client whose turn would end first by its clock, among equals the one that asked first. Returns
/// nullptr if none waits.
std::shared_ptr<FrameCompressor::Client> FrameCompressor::take_first() noexcept {
    while (!waiting_.empty()) {
        const auto first = std::min_element(waiting_.begin(), waiting_.end(),
                                            [](const auto& a, const auto& b) { return a.end < b.end; });
        const auto client = first->client.lock();
        if (client) {
            client->clock_ = first->start;
        }
        waiting_.erase(first);
        if (client) {
            return client;
        }
    }
    return nullptr;
}

void FrameCompressor::next() {
    while (!busy_) {
        auto client = take_first();
        if (!client) {
            return;
        }
        work_->request = client->next_request();
        if (work_->request.frame) {
            work_->client = std::move(client);
            begin();
        }
    }
}

void FrameCompressor::begin() {
    now_ = std::max(now_, work_->client->clock_);
    busy_ = true;
    asio::post(worker_, [this, &server = server_, work = work_] {
        work->run();
        asio::post(server, [this] {
            finished();
            next();
        });
    });
}

/// Charges the client for its part of a frame that `sharers` clients get.
void FrameCompressor::charge(Client& client, int sharers) const noexcept {
    const std::uint64_t cost = work_->request.cost() / static_cast<std::uint64_t>(sharers);
    client.clock_ += cost;
    client.price_ = cost;
    client.account_.charge(cost, work_->time / sharers, CompressorAccount::Clock::now());
}

void FrameCompressor::finished() {
    busy_ = false;
    const auto client = std::exchange(work_->client, nullptr);
    const auto planes = std::exchange(work_->planes, nullptr);
    if (planes) {
        const int sharers =
            1 + static_cast<int>(std::count_if(waiting_.begin(), waiting_.end(), [this](const Waiting& place) {
                const auto other = place.client.lock();
                return other && other->same_request(work_->request);
            }));
        const std::size_t waiting = waiting_.size();  // clients that ask from here on are queued behind these
        charge(*client, sharers);
        client->compressed(work_->request, planes);
        hand_to_others(planes, sharers, waiting);
    } else {
        client->not_compressed(std::exchange(work_->failure, {}));
    }
    work_->request = {};
}

/// Gives the planes to those of the first `waiting` clients that want the same; they need no turn of their own.
void FrameCompressor::hand_to_others(const std::shared_ptr<const EncodedPlanes>& planes, int sharers,
                                     std::size_t waiting) {
    std::size_t place = 0;
    for (std::size_t left = waiting; left > 0; --left) {
        const auto other = waiting_[place].client.lock();
        if (other && !other->same_request(work_->request)) {
            ++place;
            continue;
        }
        const std::uint64_t start = waiting_[place].start;
        waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(place));
        if (other) {
            other->clock_ = start;
            charge(*other, sharers);
            other->next_request();  // takes the frame out of its queue
            other->compressed(work_->request, planes);
        }
    }
}

}  // namespace disparityd::daemon
