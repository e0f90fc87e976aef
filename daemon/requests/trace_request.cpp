// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/trace_request.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "daemon/requests/trace_message.h"

namespace disparityd::daemon {

Request trace_request(TraceService& trace) {
    return {.message = v1::Envelope::kTraceRequest,
            .name = "trace_request",
            .word = "trace",
            .handle = [&trace](const v1::Envelope& message, const Requester&, Reply reply) {
                trace.ask(message.trace_request(), std::move(reply));
            }};
}

void TraceService::ask(const v1::TraceRequest& request, Reply reply) {
    const double seconds = request.seconds();
    if (!(seconds >= least_seconds && seconds <= most_seconds)) {
        reply(refusal_of(
            fmt::format("trace: seconds: found {}, allowed: {} to {}", seconds, least_seconds, most_seconds)));
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        if (!reply_ && on_its_way_.expired()) {
            reply_ = std::exchange(reply, {});
        }
    }
    if (reply) {
        reply(refusal_of(fmt::format("trace: another one is being taken or read: ask again in {} s", most_seconds)));
        return;
    }
    const std::chrono::duration<double> time(seconds);
    boost::asio::post(control_,
                      [this, time] { begin(std::chrono::duration_cast<std::chrono::steady_clock::duration>(time)); });
}

void TraceService::begin(std::chrono::steady_clock::duration time) {
    const auto engine = engine_();
    if (!engine) {
        refuse("trace: the source is being prepared; ask again");
        return;
    }
    engine->tracer().begin();
    traced_ = engine;
    timer_.expires_after(time);
    timer_.async_wait([this](const boost::system::error_code& error) {
        if (!error) {
            end();
        }
    });
}

void TraceService::end() {
    const auto engine = std::exchange(traced_, {}).lock();
    if (!engine || engine != engine_()) {
        refuse("trace: the configuration was loaded again, or the source opened anew, meanwhile; ask again");
        return;
    }
    Answer answer;
    for (v1::Trace& part : to_messages(engine->tracer().end())) {
        *answer.messages.emplace_back().mutable_trace() = std::move(part);
    }
    answer.held = std::make_shared<char>();
    const Reply reply = take_reply();
    {
        const std::lock_guard lock(mutex_);
        on_its_way_ = answer.held;
    }
    reply(std::move(answer));
}

void TraceService::refuse(const std::string& why) {
    if (const Reply reply = take_reply()) {
        reply(refusal_of(why));
    }
}

Reply TraceService::take_reply() {
    const std::lock_guard lock(mutex_);
    return std::exchange(reply_, {});
}

}  // namespace disparityd::daemon
