// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/live/encoding_turns.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>

namespace disparityd::web {

void EncodingTurns::add(const std::string& peer, Job job) {
    {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                        [&peer](const Peer& waiting) { return waiting.name == peer; });
        if (found != waiting_.end()) {
            found->jobs.push_back(std::move(job));
        } else {
            waiting_.push_back({peer, {}});
            waiting_.back().jobs.push_back(std::move(job));
        }
    }
    // As many turns as there are jobs.
    boost::asio::post(thread_, [this] { run_next(); });
}

void EncodingTurns::run_next() {
    Job job;
    {
        const std::lock_guard lock(mutex_);
        Peer& peer = waiting_.front();
        job = std::move(peer.jobs.front());
        peer.jobs.pop_front();
        if (peer.jobs.empty()) {
            waiting_.pop_front();
        } else {
            waiting_.splice(waiting_.end(), waiting_, waiting_.begin());
        }
    }
    job();
}

}  // namespace disparityd::web
